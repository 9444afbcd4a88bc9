//! A native line while it is put together: words from the deck keep their places, words of its own have that of a word they stand for.

use perigrain_base::diag::Span;
use perigrain_lang::{Command, Word};

/// A native line that grows.
pub(crate) struct Line {
    name: Word,
    args: Vec<Word>,
    span: Span,
}

impl Line {
    /// A line of this command, made from the deck's line `cmd`.
    pub fn new(cmd: &Command, name: &str) -> Self {
        Self { name: Word::new(name, cmd.name.span), args: vec![], span: cmd.span }
    }

    /// `fix ID group STYLE` or `dump ID group STYLE`, with the deck's own ID and group.
    pub fn styled(cmd: &Command, style: &str) -> Self {
        let mut line = Self::new(cmd, &cmd.name.text);
        line.args.extend(cmd.args.iter().take(2).cloned());
        let at = cmd.args.get(2).map_or(cmd.span, |w| w.span);
        line.put(style, at);
        line
    }

    /// Gives the fix or dump another ID.
    pub fn renamed(&mut self, id: &str) -> &mut Self {
        self.args[0] = instead(&self.args[0], id);
        self
    }

    /// Adds words of its own, which stand for what is at `at`.
    pub fn put(&mut self, words: &str, at: Span) -> &mut Self {
        self.args.extend(words.split_whitespace().map(|text| Word::new(text, at)));
        self
    }

    /// Adds a word of the deck.
    pub fn word(&mut self, word: &Word) -> &mut Self {
        self.args.push(word.clone());
        self
    }

    /// Adds words of the deck.
    pub fn words(&mut self, words: &[Word]) -> &mut Self {
        self.args.extend_from_slice(words);
        self
    }

    /// The line.
    pub fn done(self) -> Command {
        let text = text(&self.name, &self.args);
        Command { name: self.name, args: self.args, span: self.span, text }
    }
}

/// A line as it is written.
fn text(name: &Word, args: &[Word]) -> String {
    let mut out = name.text.clone();
    for word in args {
        out.push(' ');
        match (word.quoted, word.text.contains('"')) {
            (true, true) => out += &format!("'{}'", word.text),
            (true, false) => out += &format!("\"{}\"", word.text),
            (false, _) => out += &word.text,
        }
    }
    out
}

/// The word with another text at the same place.
pub(crate) fn instead(word: &Word, text: impl Into<String>) -> Word {
    Word { text: text.into(), quoted: false, ..word.clone() }
}
