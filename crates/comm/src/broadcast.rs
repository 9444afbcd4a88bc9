//! Values determined by the first rank, so that they are equal on all: times, files, the environment.

use super::{present, several};

/// A number from the first rank; on the others `own` is not evaluated.
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

/// A truth value from the first rank.
pub fn truth(own: impl FnOnce() -> bool) -> bool {
    number(|| f64::from(u8::from(own()))) != 0.0
}

/// Bytes from the first rank.
pub fn bytes(own: impl FnOnce() -> Vec<u8>) -> Vec<u8> {
    if !several() {
        return own();
    }
    let comm = present();
    let mut bytes = if comm.rank() == 0 { own() } else { vec![] };
    comm.broadcast(&mut bytes);
    bytes
}

/// Text from the first rank, if it has one.
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
