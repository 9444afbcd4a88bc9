//! A page on the loopback address during a run: answers to its reader, if the request has the token of the address.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// No question is longer.
const LONGEST: u64 = 16 * 1024;
/// So many connections at a time.
const MOST: usize = 32;
/// A slower client is not waited for.
const PATIENCE: Duration = Duration::from_secs(5);

/// A question that has the token and comes from the page itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Whether it requests an action.
    pub acts: bool,
    /// What it requests: `/`, `/state`, …
    pub path: String,
    /// The value behind `since=`.
    pub since: usize,
}

/// The answer to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Its content type.
    pub kind: &'static str,
    /// Its content.
    pub body: Vec<u8>,
}

/// A listener on the loopback address alone, and the rules for requests.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
}

impl Server {
    /// Listens on a port; 0 takes any that is free.
    ///
    /// # Errors
    /// A port that is in use or not allowed.
    pub fn on(port: u16, token: String) -> std::io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address, token })
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        format!("http://{}/?token={}", self.address, self.token)
    }

    /// Answers questions for good. Browsers open connections that they use later or never: each is a thread's own.
    pub fn serve(&self, answer: impl Fn(&Question) -> Option<Answer> + Sync) {
        let open = AtomicUsize::new(0);
        std::thread::scope(|threads| {
            for stream in self.listener.incoming().flatten() {
                if open.fetch_add(1, Ordering::Relaxed) >= MOST {
                    open.fetch_sub(1, Ordering::Relaxed);
                    continue;
                }
                let (open, answer) = (&open, &answer);
                threads.spawn(move || {
                    // A reader that goes away is no matter of the run's.
                    let _ = self.one(&stream, answer);
                    open.fetch_sub(1, Ordering::Relaxed);
                });
            }
        });
    }

    fn one(&self, stream: &TcpStream, answer: &impl Fn(&Question) -> Option<Answer>) -> std::io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let head = head(stream)?;
        match allowed(&head, self.address.port(), &self.token) {
            Err((status, why)) => respond(stream, status, "text/plain", why.as_bytes()),
            Ok(question) => match answer(&question) {
                Some(a) => respond(stream, "200 OK", a.kind, &a.body),
                None => respond(stream, "404 Not Found", "text/plain", b"there is no such thing here\n"),
            },
        }
    }
}

/// The lines of a question up to the empty one. Bodies are not read: nothing here has one.
fn head(stream: &TcpStream) -> std::io::Result<Vec<String>> {
    let mut reader = BufReader::new(stream.take(LONGEST));
    let mut lines = vec![];
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let line = line.trim_end();
        if line.is_empty() {
            return Ok(lines);
        }
        lines.push(line.to_string());
    }
}

/// The question, if it has the token, names this address as its host, and comes from no other page.
fn allowed(head: &[String], port: u16, token: &str) -> Result<Question, (&'static str, &'static str)> {
    const FORBIDDEN: &str = "403 Forbidden";
    let value = |name: &str| {
        let mut values = head.iter().skip(1).filter_map(|line| line.split_once(':'));
        values.find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
    };
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    if !value("host").is_some_and(|host| own.iter().any(|o| o == host)) {
        return Err((FORBIDDEN, "the request names another host\n"));
    }
    let foreign = |origin: &str| !own.iter().any(|o| origin == format!("http://{o}"));
    if value("origin").is_some_and(foreign) {
        return Err((FORBIDDEN, "the request comes from another page\n"));
    }
    let mut words = head.first().map_or("", |l| l).split(' ');
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let acts = match method {
        "GET" => false,
        "POST" => true,
        _ => return Err(("405 Method Not Allowed", "GET and POST only\n")),
    };
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let of = |name: &str| query.split('&').find_map(|pair| pair.strip_prefix(name)?.strip_prefix('='));
    if !of("token").is_some_and(|given| same(given, token)) {
        return Err((FORBIDDEN, "open the address that the program has printed, with its token\n"));
    }
    let since = of("since").and_then(|n| n.parse().ok()).unwrap_or(0);
    Ok(Question { acts, path: path.to_string(), since })
}

/// Whether two texts are the same, in a time that does not depend on where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |d, (a, b)| d | (a ^ b)) == 0
}

fn respond(mut stream: &TcpStream, status: &str, kind: &str, body: &[u8]) -> std::io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\nCross-Origin-Resource-Policy: same-origin\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}

/// 128 bits that cannot be guessed: the seeds of the standard library's hash maps come from the system.
pub fn token() -> String {
    use std::hash::{BuildHasher, Hasher, RandomState};
    (0..2).map(|_| format!("{:016x}", RandomState::new().build_hasher().finish())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(lines: &[&str]) -> Result<Question, &'static str> {
        let head: Vec<String> = lines.iter().map(ToString::to_string).collect();
        allowed(&head, 8080, "secret").map_err(|(_, why)| why)
    }

    #[test]
    fn only_the_page_itself_is_answered() {
        let get = "GET /state?token=secret&since=7 HTTP/1.1";
        let question = Question { acts: false, path: "/state".into(), since: 7 };
        assert_eq!(request(&[get, "Host: 127.0.0.1:8080"]), Ok(question.clone()));
        assert_eq!(request(&[get, "HOST: localhost:8080", "origin: http://localhost:8080"]), Ok(question));
        for (lines, why) in [
            (&[get][..], "host"),
            (&[get, "Host: evil.example:8080"], "host"),
            (&[get, "Host: 127.0.0.1:8081"], "host"),
            (&[get, "Host: 127.0.0.1:8080", "Origin: http://evil.example"], "page"),
            (&[get, "Host: 127.0.0.1:8080", "Origin: null"], "page"),
            (&["GET / HTTP/1.1", "Host: 127.0.0.1:8080"], "token"),
            (&["GET /?token=secre HTTP/1.1", "Host: 127.0.0.1:8080"], "token"),
            (&["PUT /?token=secret HTTP/1.1", "Host: 127.0.0.1:8080"], "POST"),
            (&["", "Host: 127.0.0.1:8080"], "POST"),
        ] {
            assert!(request(lines).unwrap_err().contains(why), "{lines:?}");
        }
        assert!(request(&[]).is_err());
    }

    #[test]
    fn tokens_are_long_and_differ() {
        assert_eq!(token().len(), 32);
        assert_ne!(token(), token());
    }
}
