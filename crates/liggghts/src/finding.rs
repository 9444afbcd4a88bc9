//! Finding a line's word in the table of LIGGGHTS' words.

use crate::words::{Entry, TABLE, Take};
use perigrain_lang::Command;

/// At which word behind the command its style stands.
pub(crate) fn style_at(command: &str) -> usize {
    match command {
        "fix" | "compute" | "dump" => 2,
        "region" => 1,
        _ => 0,
    }
}

/// The word of LIGGGHTS that a line begins with.
pub(crate) fn find(cmd: &Command) -> Option<&'static Entry> {
    let command = cmd.name.text.as_str();
    let style = cmd.args.get(style_at(command)).map_or("", |w| w.text.as_str());
    let fits = |e: &&Entry| {
        e.command == command
            && match (e.style.strip_suffix('*'), e.style.strip_prefix('*')) {
                (Some(start), _) => style.starts_with(start),
                (_, Some(end)) => style.ends_with(end),
                _ => e.style.is_empty() || e.style == style,
            }
    };
    TABLE.iter().find(fits)
}

/// The styles that LIGGGHTS has of a kind and that are read here.
pub fn known(command: &str) -> impl Iterator<Item = &'static str> {
    let of = command.to_string();
    let read = move |e: &&Entry| {
        e.command == of
            && !e.style.is_empty()
            && !matches!(e.take, Take::Refused(..))
            && !e.style.contains('*')
    };
    TABLE.iter().filter(read).map(|e| e.style)
}
