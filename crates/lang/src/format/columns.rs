//! Which column each word and each comment stands in, and the text that comes of it.

use super::rows::{Piece, Row};
use std::collections::BTreeMap;

/// Columns that a continuation stands further in.
const CONTINUED: usize = 4;

/// Blanks before a comment whose column is not given by others.
const BEFORE_COMMENT: usize = 2;

/// A line that ends further to the right does not count for the column of the others' comments.
const FAR: usize = 90;

/// The rows as text.
pub(super) fn written(rows: &[Row<'_>], ending: &str) -> String {
    let columns = words_of(rows);
    let ends: Vec<usize> = rows.iter().zip(&columns).map(|(row, columns)| end(row, columns)).collect();
    let starts: Vec<usize> = columns.iter().map(|columns| columns[0]).collect();
    let comments = comments_of(rows, &starts, &ends);
    let mut out = String::new();
    for (k, row) in rows.iter().enumerate() {
        if let Some(whole) = row.whole {
            out += whole;
            if !whole.ends_with('\n') {
                out += ending;
            }
            continue;
        }
        let mut line = Line { out: &mut out, column: 0 };
        for (word, column) in row.words.iter().zip(&columns[k]) {
            line.put(word.text, *column);
        }
        if row.joined {
            let column = if row.words.is_empty() { starts[k] } else { line.column + 1 };
            line.put("&", column);
        }
        if let Some(comment) = row.comment {
            let column = if row.broken { line.column + BEFORE_COMMENT } else { comments[k] };
            line.put(comment.text, column);
        }
        out += if row.ending.is_empty() { ending } else { row.ending };
    }
    out
}

struct Line<'a> {
    out: &'a mut String,
    column: usize,
}

impl Line<'_> {
    fn put(&mut self, text: &str, column: usize) {
        let blanks = column.saturating_sub(self.column);
        self.out.extend(std::iter::repeat_n(' ', blanks));
        self.out.push_str(text);
        self.column += blanks + text.chars().count();
    }
}

/// The column behind a row's last word and its `&`.
fn end(row: &Row<'_>, columns: &[usize]) -> usize {
    let words = row.words.last().zip(columns.last()).map_or(0, |(word, column)| column + word.width());
    words + if row.joined { 2 } else { 0 }
}

/// The columns of all words. Each row has a first one, even if it has no word.
fn words_of(rows: &[Row<'_>]) -> Vec<Vec<usize>> {
    let mut columns: Vec<Vec<usize>> = rows.iter().map(|row| vec![row.indent]).collect();
    let most = rows.iter().map(|row| row.words.len()).max().unwrap_or(0);
    // Rows that have a word of this number: with each one more there are fewer.
    let (mut first, mut continued): (Vec<usize>, Vec<usize>) = (0..rows.len()).partition(|&k| rows[k].first);
    first.retain(|&k| rows[k].words.len() > 1);
    place(rows, &first, 1, &mut columns);
    let mut head = 0;
    for k in 0..rows.len() {
        if rows[k].first {
            head = k;
        } else {
            columns[k][0] = continuation(&rows[head], &columns[head], &rows[k]);
        }
    }
    continued.retain(|&k| rows[k].words.len() > 1);
    place(rows, &continued, 1, &mut columns);
    let mut left = [first, continued].concat();
    left.sort_unstable();
    for n in 2..most {
        left.retain(|&k| rows[k].words.len() > n);
        place(rows, &left, n, &mut columns);
    }
    columns
}

/// Where a continuation begins: below the first argument if it stood there, else a little further in than its line.
fn continuation(head: &Row<'_>, columns: &[usize], row: &Row<'_>) -> usize {
    let argument = head.words.get(1).zip(columns.get(1));
    let begins = row.words.first().or(row.comment.as_ref()).map(|piece| piece.column);
    match argument {
        Some((word, column)) if begins == Some(word.column) && !torn(head, 1) => *column,
        _ => head.indent + CONTINUED,
    }
}

/// Whether the column of word number `n` is unknown: a word before it contains a line break or a tab.
fn torn(row: &Row<'_>, n: usize) -> bool {
    row.broken && row.words[..n].iter().any(|word| word.text.contains(['\n', '\t']))
}

/// Gives the words number `n` of some rows their columns.
fn place(rows: &[Row<'_>], some: &[usize], n: usize, columns: &mut [Vec<usize>]) {
    for group in groups(rows, some, n) {
        let least = |k: usize| columns[k][n - 1] + rows[k].words[n - 1].width() + 1;
        let needed = group.iter().map(|&k| least(k)).max().unwrap_or(0);
        let given = rows[group[0]].words[n].column;
        let agreed = group.iter().all(|&k| rows[k].words[n].column == given);
        let alone = group.len() == 1;
        let column = if agreed && !alone { needed.max(given) } else { needed };
        group.iter().for_each(|&k| columns[k].push(column));
    }
}

/// Rows whose words number `n` stand in one column.
fn groups(rows: &[Row<'_>], left: &[usize], n: usize) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = vec![];
    let mut last: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for &k in left {
        let row = &rows[k];
        if torn(row, n) {
            groups.push(vec![k]);
            continue;
        }
        let key = match (row.first, n) {
            (true, 1) => "",
            (true, _) => row.words[0].text,
            // Continuations have their own columns; no command has a line break in it.
            (false, _) => "\n",
        };
        let before = last.get(key).copied().filter(|&(other, _)| {
            let next = other + 1 == k;
            let alike = next && (n > 1 || rows[other].words[0].text == row.words[0].text || !row.first);
            aligned(&rows[other].words[n], &row.words[n], alike) && (row.first || next)
        });
        let group = match before {
            Some((_, group)) => group,
            None => {
                groups.push(vec![]);
                groups.len() - 1
            }
        };
        groups[group].push(k);
        last.insert(key, (k, group));
    }
    groups
}

/// Whether two words were meant to stand one below the other; in neighbouring lines that are `alike` they need not do so yet.
fn aligned(a: &Piece<'_>, b: &Piece<'_>, alike: bool) -> bool {
    let (wide, wider) = (a.gap > 1 || b.gap > 1, a.gap > 1 && b.gap > 1);
    (a.column == b.column && wide) || (alike && wider)
}

/// The columns of all comments; 0 where there is none.
fn comments_of(rows: &[Row<'_>], starts: &[usize], ends: &[usize]) -> Vec<usize> {
    let mut columns = vec![0; rows.len()];
    let mut k = 0;
    while k < rows.len() {
        let run = run_of(rows, k);
        if run == 0 {
            columns[k] = starts[k];
            k += 1;
            continue;
        }
        let here = k..k + run;
        let given: Vec<usize> =
            here.clone().filter_map(|k| rows[k].comment.map(|comment| comment.column)).collect();
        let target = agreed(&given).unwrap_or_else(|| {
            let ends = here.clone().map(|k| ends[k]).filter(|&end| end <= FAR);
            ends.max().map_or(0, |end| end + BEFORE_COMMENT)
        });
        for k in here {
            let Some(comment) = rows[k].comment else { continue };
            columns[k] = match (target > ends[k], comment.column > ends[k]) {
                (true, _) => target,
                (false, true) => comment.column,
                (false, false) => ends[k] + BEFORE_COMMENT,
            };
        }
        k += run;
    }
    columns
}

/// How many rows from `k` on have comments that stand one below the other: behind words, or below such a comment.
fn run_of(rows: &[Row<'_>], k: usize) -> usize {
    let behind_words = |row: &Row<'_>| row.comment.is_some() && !row.is_comment() && !row.broken;
    if !behind_words(&rows[k]) {
        return 0;
    }
    let mut below = rows[k].comment.map_or(0, |comment| comment.column);
    let more = rows[k + 1..].iter().take_while(|row| {
        let continues =
            row.is_comment() && row.comment.is_some_and(|comment| comment.column == below && below > 0);
        let takes = continues || behind_words(row);
        below = row.comment.map_or(0, |comment| comment.column);
        takes
    });
    1 + more.count()
}

/// The column that most have, the first of several; none if no two agree. One alone agrees with itself.
fn agreed(given: &[usize]) -> Option<usize> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    given.iter().for_each(|column| *counts.entry(*column).or_default() += 1);
    let most = counts.values().max().copied()?;
    let (column, _) = counts.iter().find(|(_, n)| **n == most)?;
    (most > 1 || given.len() == 1).then_some(*column)
}
