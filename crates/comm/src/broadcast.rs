//! Values that only the first rank finds out, so that they are the same on all: times, files, the environment.

use super::{present, several};

/// A number of the first rank; others need not find it out.
pub fn number(own: impl FnOnce() -> f64) -> f64 {
    if !several() {
        return own();
    }
    let comm = present();
    let mut bytes = if comm.rank() == 0 { own().to_le_bytes().to_vec() } else { vec![] };
    comm.broadcast(&mut bytes);
    let mut value = [0; 8];
    value.copy_from_slice(&bytes[..8]);
    f64::from_le_bytes(value)
}

/// A yes or no of the first rank.
pub fn truth(own: impl FnOnce() -> bool) -> bool {
    number(|| f64::from(u8::from(own()))) != 0.0
}

/// Bytes of the first rank.
pub fn bytes(own: impl FnOnce() -> Vec<u8>) -> Vec<u8> {
    if !several() {
        return own();
    }
    let comm = present();
    let mut bytes = if comm.rank() == 0 { own() } else { vec![] };
    comm.broadcast(&mut bytes);
    bytes
}

/// Text of the first rank, or that it has none.
pub fn text(own: impl FnOnce() -> Option<String>) -> Option<String> {
    if !several() {
        return own();
    }
    let sent = bytes(|| match own() {
        None => vec![0],
        Some(text) => [&[1], text.as_bytes()].concat(),
    });
    (sent[0] == 1).then(|| String::from_utf8_lossy(&sent[1..]).into_owned())
}
