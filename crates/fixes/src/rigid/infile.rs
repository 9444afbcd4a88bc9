//! `infile` of fix rigid: mass, inertia and motion of bodies from a file.

use super::Declared;
use super::bodies::orient;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::vec3::add;
use perigrain_geometry::text::{Line, Lines, load, number, plain, whole};
use perigrain_lang::Word;
use perigrain_world::World;

/// Words of a line: number, mass, centre, inertia, velocity, angular momentum, image counts.
const WORDS: usize = 20;

/// Changes the bodies listed in the file.
///
/// # Errors
/// Unreadable files, malformed lines, unknown bodies.
pub fn apply(fix: &Declared, w: &mut World, file: &Word) -> Result<()> {
    let beside = w.folder.join(&file.text);
    let path = if perigrain_base::gate::exists(&beside) { beside } else { file.text.clone().into() };
    w.read_files.note(&path);
    let text = load(&path).map_err(|e| {
        let text = format!("the file `{}` cannot be read: {e}", file.text);
        Diagnostic::error(perigrain_base::gate::code(&e), file.span, text)
    })?;
    let text = plain(w, text);
    read(fix, w, &text.text).map_err(|e| e.within(&text))
}

fn read(fix: &Declared, w: &mut World, text: &str) -> Result<()> {
    let mut lines = Lines::new(text);
    let Some(first) = lines.take_filled() else {
        return fail(Code::INCOMPLETE, lines.end(), "the file is empty: it begins with the number of bodies");
    };
    let count = whole(&first, first.word(0), "the number of bodies")?;
    let mut bodies = fix.load(w);
    let number_of = w.columns.get_scalar(fix.keys.body).unwrap_or_default().to_vec();
    let (edges, flat) = (w.domain()?.edges(), w.settings.two_dimensional);
    for have in 0..count {
        let Some(line) = lines.take_filled() else {
            let text = format!("the first line promises {count} bodies, the file has {have}");
            return fail(Code::INCOMPLETE, first.span(), text);
        };
        let row = row(&line)?;
        let name = row[0];
        let found = match fix.style {
            "rigid" | "rigid/nve" => (name >= 1.0).then_some(name as usize - 1).filter(|k| *k < bodies.len()),
            _ => bodies.iter().position(|b| b.name == name),
        };
        let Some(k) = found else {
            let text = format!("there is no body {}", line.word(0));
            return fail(Code::UNKNOWN_NAME, line.span_of(line.word(0)), text);
        };
        let three = |k: usize| [row[k], row[k + 1], row[k + 2]];
        let b = &mut bodies[k];
        b.mass = row[1];
        (b.v, b.momentum, b.image) = (three(11), three(14), three(17));
        b.x = add(three(2), edges.shift(b.image));
        orient(b, [row[5], row[6], row[7], row[8], row[9], row[10]], flat);
        let body = *b;
        let members: Vec<usize> = (0..w.n()).filter(|&i| number_of[i] == k as f64 + 1.0).collect();
        fix.place(w, &body, &members);
        fix.weigh(w, &members, body.mass);
    }
    fix.store(w, &bodies);
    Ok(())
}

fn row(line: &Line) -> Result<[f64; WORDS]> {
    let mut row = [0.0; WORDS];
    let mut n = 0;
    for word in line.words() {
        if let Some(slot) = row.get_mut(n) {
            *slot = number(line, word, "a property of a body")?;
        }
        n += 1;
    }
    if n != WORDS {
        return fail(Code::SYNTAX, line.span(), format!("{WORDS} numbers are needed here, not {n}"));
    }
    if row[1] <= 0.0 {
        return fail(Code::BAD_VALUE, line.span_of(line.word(1)), "the mass must be greater than zero");
    }
    Ok(row)
}
