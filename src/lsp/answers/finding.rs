//! Where a name is defined and used, and all its places with another name.

use crate::lsp::names::{Kind, Mention, Role};
use crate::lsp::server::{File, Server};
use serde_json::{Map, Value, json};
use std::sync::Arc;

fn location(file: &File, mention: &Mention) -> Value {
    json!({"uri": file.uri, "range": file.text.range(mention.bytes.clone())})
}

/// Places with their files.
type Places = Vec<(Arc<File>, Mention)>;

/// All places of a name in the files of its deck. A label belongs to its file.
fn places(server: &mut Server, file: &Arc<File>, of: &Mention) -> Places {
    let files = match of.kind {
        Kind::Label => vec![file.clone()],
        _ => server.family(file),
    };
    let each = |file: Arc<File>| {
        let found = file.index.places(of.kind, &of.name);
        found.into_iter().map(move |mention| (file.clone(), mention)).collect::<Vec<_>>()
    };
    files.into_iter().flat_map(each).collect()
}

/// Where the name at a byte is defined; the file behind the name of one.
pub fn definition(server: &mut Server, file: &Arc<File>, byte: usize) -> Value {
    let Some(mention) = file.index.at(byte) else { return Value::Null };
    if mention.kind == Kind::File {
        let Some(named) = server.named(&mention.name, file) else { return Value::Null };
        return json!([{"uri": named.uri, "range": named.text.range(0..0)}]);
    }
    if mention.kind == Kind::Label
        && let Some((words, _)) = file.index.word_at(byte)
        && let Some(target) = words.get(1).filter(|w| words[0].text == "jump" && w.text != "SELF")
        && let Some(other) = server.named(&target.text, file)
    {
        let there = other.index.places(Kind::Label, &mention.name);
        return there.iter().filter(|m| m.role == Role::Defines).map(|m| location(&other, m)).collect();
    }
    let all = places(server, file, &mention);
    all.iter().filter(|(_, m)| m.role == Role::Defines).map(|(file, m)| location(file, m)).collect()
}

/// All places of the name at a byte.
pub fn references(server: &mut Server, file: &Arc<File>, byte: usize, with_definitions: bool) -> Value {
    let Some(mention) = file.index.at(byte) else { return json!([]) };
    let all = places(server, file, &mention);
    let wanted = all.iter().filter(|(_, m)| with_definitions || m.role != Role::Defines);
    wanted.map(|(file, m)| location(file, m)).collect()
}

/// The places of the name at a byte within its file, for marking them.
pub fn highlights(file: &Arc<File>, byte: usize) -> Value {
    let Some(mention) = file.index.at(byte) else { return json!([]) };
    let kind = |m: &Mention| if m.role == Role::Defines { 3 } else { 2 };
    let places = file.index.places(mention.kind, &mention.name);
    places.iter().map(|m| json!({"range": file.text.range(m.bytes.clone()), "kind": kind(m)})).collect()
}

/// The name at a byte if it can be changed.
fn to_rename(server: &mut Server, file: &Arc<File>, byte: usize) -> Result<(Mention, Places), String> {
    let mention = file.index.at(byte).ok_or("there is no name here")?;
    if mention.kind == Kind::File {
        return Err("files are renamed where they lie".into());
    }
    let all = places(server, file, &mention);
    if !all.iter().any(|(_, m)| m.role == Role::Defines) {
        return Err(format!("{} `{}` is not defined in this deck", mention.kind.word(), mention.name));
    }
    Ok((mention, all))
}

/// What a new name would replace.
///
/// # Errors
/// No name of the deck's own is there.
pub fn prepare_rename(server: &mut Server, file: &Arc<File>, byte: usize) -> Result<Value, String> {
    let (mention, _) = to_rename(server, file, byte)?;
    Ok(json!({"range": file.text.range(mention.bytes.clone()), "placeholder": mention.name}))
}

/// The edits that give the name at a byte another one.
///
/// # Errors
/// A new name that is none or is taken, or no name there.
pub fn rename(server: &mut Server, file: &Arc<File>, byte: usize, new: &str) -> Result<Value, String> {
    let (mention, all) = to_rename(server, file, byte)?;
    let plain = !new.is_empty() && new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let label = mention.kind == Kind::Label
        && !new.is_empty()
        && !new.contains(|c: char| c.is_whitespace() || "\"'#$&".contains(c));
    if !plain && !label {
        return Err(format!("`{new}` is no name: letters, digits and _ only"));
    }
    let named = Mention { name: new.to_string(), ..mention.clone() };
    let taken = places(server, file, &named).iter().any(|(_, m)| m.role == Role::Defines);
    if new != mention.name && taken || (mention.kind == Kind::Group && new == "all") {
        return Err(format!("there is a {} `{new}` already", mention.kind.word()));
    }
    let mut changes: Map<String, Value> = Map::new();
    for (file, m) in all {
        // `$x` takes one letter; a longer name needs braces.
        let bare = m.bytes.start > 0 && file.text.as_str().as_bytes()[m.bytes.start - 1] == b'$';
        let text = if bare && new.len() > 1 { format!("{{{new}}}") } else { new.to_string() };
        let edit = json!({"range": file.text.range(m.bytes.clone()), "newText": text});
        let edits = changes.entry(file.uri.clone()).or_insert_with(|| json!([]));
        edits.as_array_mut().into_iter().for_each(|edits| edits.push(edit.clone()));
    }
    Ok(json!({"changes": changes}))
}
