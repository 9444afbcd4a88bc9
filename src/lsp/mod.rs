//! `perigrain lsp`: the language server, which answers editors' requests about decks over standard input and output.
//!
//! One thread reads, one writes, one checks decks, and one answers: from texts and the manual alone, so that no answer waits for
//! a check.

mod answers;
mod checks;
mod names;
mod places;
mod server;
mod wire;

use answers::{completion, finding, fixes, hover, outline};
use checks::{Checker, Report};
use perigrain_base::diag::FileId;
use perigrain_lang::format::format;
use serde_json::{Value, json};
use server::{File, Server};
use std::io::{BufRead, BufReader, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use wire::Heard;

/// What happens.
enum Event {
    Heard(Heard),
    Checked(Report),
    End,
}

/// Why a request has no result: a code of the protocol and a sentence.
struct Refusal(i64, String);

const PARSE_ERROR: i64 = -32700;
const INVALID_REQUEST: i64 = -32600;
const METHOD_NOT_FOUND: i64 = -32601;
const INVALID_PARAMS: i64 = -32602;
const INTERNAL_ERROR: i64 = -32603;
const NOT_INITIALIZED: i64 = -32002;
const REQUEST_FAILED: i64 = -32803;

/// Answers until the client sends `exit` or closes the stream; whether it has sent `shutdown` before.
pub fn serve(input: impl Read + Send + 'static, output: impl Write + Send + 'static) -> bool {
    let (events, queue) = channel();
    let (out, written) = channel();
    let writer = std::thread::spawn(move || write_all(&written, output));
    let heard = events.clone();
    std::thread::spawn(move || read_all(BufReader::new(input), &heard));
    let checker = Checker::new(move |report| drop(events.send(Event::Checked(report))));
    let mut talk = Talk { server: Server::new(checker, out), begun: false, over: false };
    let clean = talk.listen(&queue);
    drop(talk);
    // What has been answered reaches the client before the program ends.
    let _ = writer.join();
    clean
}

fn read_all(mut input: impl BufRead, events: &Sender<Event>) {
    while let Ok(Some(heard)) = wire::read(&mut input) {
        if events.send(Event::Heard(heard)).is_err() {
            return;
        }
    }
    let _ = events.send(Event::End);
}

fn write_all(messages: &Receiver<Value>, mut output: impl Write) {
    while let Ok(message) = messages.recv() {
        if wire::write(&mut output, &message).is_err() {
            return;
        }
    }
}

/// A talk with a client.
struct Talk {
    server: Server,
    /// `initialize` was received.
    begun: bool,
    /// `shutdown` was received.
    over: bool,
}

impl Talk {
    fn listen(&mut self, queue: &Receiver<Event>) -> bool {
        while let Ok(event) = queue.recv() {
            match event {
                Event::End => return self.over,
                Event::Checked(report) => self.server.take(report),
                Event::Heard(Heard::Garbled(why)) => {
                    self.server.send(refused(&Value::Null, &Refusal(PARSE_ERROR, why)));
                }
                Event::Heard(Heard::Message(message)) => {
                    if message.get("method").and_then(Value::as_str) == Some("exit") {
                        return self.over;
                    }
                    self.hear(&message);
                }
            }
        }
        self.over
    }

    fn hear(&mut self, message: &Value) {
        let params = message.get("params").unwrap_or(&Value::Null);
        let Some(method) = message.get("method").and_then(Value::as_str) else {
            // An answer to a request that was never made, or nothing at all.
            if message.get("result").is_none() && message.get("error").is_none() {
                let id = message.get("id").unwrap_or(&Value::Null);
                self.server.send(refused(id, &Refusal(INVALID_REQUEST, "a message without a method".into())));
            }
            return;
        };
        let Some(id) = message.get("id") else {
            if self.begun {
                // One that fails is as good as one that was not sent.
                let _ = catch_unwind(AssertUnwindSafe(|| self.note(method, params)));
            }
            return;
        };
        let answer = catch_unwind(AssertUnwindSafe(|| self.answer(method, params)));
        let failed =
            || Err(Refusal(INTERNAL_ERROR, format!("perigrain failed at `{method}`: please report it")));
        self.server.send(match answer.unwrap_or_else(|_| failed()) {
            Ok(result) => json!({"jsonrpc": "2.0", "id": id, "result": result}),
            Err(refusal) => refused(id, &refusal),
        });
    }

    /// Takes a notification in; one that is not known is passed over.
    fn note(&mut self, method: &str, params: &Value) {
        let document = &params["textDocument"];
        let Some(uri) = document["uri"].as_str() else { return };
        match method {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default().to_string();
                self.server.open(uri, document["version"].clone(), text);
            }
            "textDocument/didChange" => {
                let changes = params["contentChanges"].as_array().map_or(&[][..], Vec::as_slice);
                self.server.change(uri, document["version"].clone(), changes);
            }
            "textDocument/didClose" => self.server.close(uri),
            // Other decks may include it.
            "textDocument/didSave" => self.server.check(uri),
            _ => {}
        }
    }

    fn answer(&mut self, method: &str, params: &Value) -> Result<Value, Refusal> {
        match (method, self.begun, self.over) {
            ("initialize", false, _) => {
                self.begun = true;
                return Ok(abilities());
            }
            ("initialize", true, _) => return Err(Refusal(INVALID_REQUEST, "initialized already".into())),
            (_, false, _) => return Err(Refusal(NOT_INITIALIZED, "`initialize` comes first".into())),
            (_, _, true) => return Err(Refusal(INVALID_REQUEST, "`shutdown` was received".into())),
            ("shutdown", ..) => {
                self.over = true;
                return Ok(Value::Null);
            }
            ("completionItem/resolve", ..) => return Ok(completion::resolve(params.clone())),
            _ if !ANSWERED.contains(&method) => {
                return Err(Refusal(METHOD_NOT_FOUND, format!("perigrain does not know `{method}`")));
            }
            _ => {}
        }
        let uri = params["textDocument"]["uri"].as_str();
        let uri = uri.ok_or_else(|| Refusal(INVALID_PARAMS, "no textDocument.uri".into()))?;
        let file = self.server.opened(uri);
        let file = file.ok_or_else(|| Refusal(INVALID_PARAMS, format!("`{uri}` is not open")))?;
        let byte = file.text.byte_at(&params["position"]);
        self.of_file(method, params, &file, byte)
    }

    fn of_file(
        &mut self,
        method: &str,
        params: &Value,
        file: &Arc<File>,
        byte: usize,
    ) -> Result<Value, Refusal> {
        let server = &mut self.server;
        let cannot = |why: String| Refusal(REQUEST_FAILED, why);
        Ok(match method {
            "textDocument/completion" => completion::complete(server, file, byte),
            "textDocument/hover" => hover::hover(server, file, byte),
            "textDocument/signatureHelp" => hover::signature(server, file, byte),
            "textDocument/definition" => finding::definition(server, file, byte),
            "textDocument/references" => {
                let with = params["context"]["includeDeclaration"].as_bool().unwrap_or(true);
                finding::references(server, file, byte, with)
            }
            "textDocument/documentHighlight" => finding::highlights(file, byte),
            "textDocument/prepareRename" => finding::prepare_rename(server, file, byte).map_err(cannot)?,
            "textDocument/rename" => {
                let new = params["newName"].as_str().unwrap_or_default();
                finding::rename(server, file, byte, new).map_err(cannot)?
            }
            "textDocument/documentSymbol" => outline::symbols(file),
            "textDocument/codeAction" => {
                let only = params["context"]["only"].as_array();
                let wanted = only.is_none_or(|only| only.iter().any(|kind| kind == "quickfix" || kind == ""));
                let range = file.text.bytes_at(&params["range"]);
                if wanted { fixes::actions(server, file, &range) } else { json!([]) }
            }
            _ => formatted(file)?,
        })
    }
}

/// Requests about a file.
const ANSWERED: [&str; 11] = [
    "textDocument/completion",
    "textDocument/hover",
    "textDocument/signatureHelp",
    "textDocument/definition",
    "textDocument/references",
    "textDocument/documentHighlight",
    "textDocument/prepareRename",
    "textDocument/rename",
    "textDocument/documentSymbol",
    "textDocument/codeAction",
    "textDocument/formatting",
];

/// The edit that lays a file out anew, if anything changes.
fn formatted(file: &File) -> Result<Value, Refusal> {
    let old = file.text.as_str();
    let new = format(old, FileId(0)).map_err(|e| Refusal(REQUEST_FAILED, e.to_string()))?;
    Ok(if new == old { json!([]) } else { json!([{"range": file.text.whole(), "newText": new}]) })
}

fn refused(id: &Value, refusal: &Refusal) -> Value {
    json!({"jsonrpc": "2.0", "id": id, "error": {"code": refusal.0, "message": refusal.1}})
}

/// What the server can do.
fn abilities() -> Value {
    json!({
        "serverInfo": {"name": "perigrain", "version": env!("CARGO_PKG_VERSION")},
        "capabilities": {
            "positionEncoding": "utf-16",
            "textDocumentSync": {"openClose": true, "change": 2, "save": {"includeText": false}},
            "completionProvider": {"triggerCharacters": [" ", "_", "{", "$", "/"], "resolveProvider": true},
            "hoverProvider": true,
            "signatureHelpProvider": {"triggerCharacters": [" "]},
            "definitionProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "renameProvider": {"prepareProvider": true},
            "documentSymbolProvider": true,
            "codeActionProvider": {"codeActionKinds": ["quickfix"]},
            "documentFormattingProvider": true,
        },
    })
}
