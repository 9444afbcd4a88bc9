//! `pair_modify`: options of LAMMPS' pair styles, of which some here know how types are mixed.

use super::declaration::{Context, Declared};
use super::node::Graph;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_pairs::Mix;
use perigrain_world::{GroupId, World};

const KEYWORDS: [&str; 13] = [
    "pair",
    "mix",
    "shift",
    "tail",
    "table",
    "table/disp",
    "tabinner",
    "tabinner/disp",
    "compute",
    "nofdotr",
    "neigh/trim",
    "special",
    "compute/tally",
];

/// `pair_modify keyword value …`: read whole; keywords without effect here get a note.
pub fn pair_modify(graph: &mut Graph, w: &mut World, args: &mut Args, cx: &Context) -> Result<Declared> {
    let Some(node) = &graph.pair else {
        return fail(Code::WRONG_ORDER, args.name_span(), "pair_modify comes before any pair_style");
    };
    args.clone().expect("a keyword such as shift or mix")?;
    let (facts, mut pair) = (node.pair.facts(), node.pair.clone());
    if args.eat("pair") {
        part(&node.pair.parts().iter().map(|p| p.facts().name).collect::<Vec<_>>(), args)?;
    }
    let (mut shift, mut tail, mut idle) = (false, false, false);
    while let Some(word) = args.next() {
        match word.text.as_str() {
            "mix" => {
                if facts.mixes {
                    pair.modify("pair_modify", args, &cx.build(graph, w, "", GroupId::ALL))?;
                } else {
                    Mix::read(args)?;
                }
            }
            "shift" => shift = args.flag("shift")?,
            "tail" => tail = args.flag("tail")?,
            "table" | "table/disp" => {
                args.integer_from(0, "the length of the table")?;
            }
            "tabinner" | "tabinner/disp" => {
                args.number("where the table begins")?;
            }
            "neigh/trim" | "compute/tally" => {
                args.flag(&word.text)?;
            }
            "nofdotr" => {}
            "compute" => {
                let span = args.here();
                if !args.flag("compute")? {
                    let d = Diagnostic::error(Code::NOT_SUPPORTED, span, "forces that are not computed");
                    return Err(d.help("leave the style out, or write `pair_style none`").into());
                }
            }
            "special" => {
                let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, "weights for one sub-style alone");
                return Err(d.help("`special_bonds` sets them for all").into());
            }
            _ => return Err(args.unknown(word, &KEYWORDS)),
        }
        idle |= word.text != "mix" || !facts.mixes;
        if tail && (shift || w.settings.two_dimensional) {
            let with = if shift { "`shift yes`" } else { "two dimensions" };
            return fail(Code::CONFLICT, args.span(), format!("`tail yes` does not go with {with}"));
        }
    }
    if idle {
        let text = match facts.mixes {
            true => "without effect but for `mix`: no pair style here has a shift, a tail or a table",
            false => {
                "without effect: no pair style here has a shift, a tail or a table, and this one has one mixing rule"
            }
        };
        let note = Diagnostic::note(Code::NO_EFFECT, cx.span, text);
        cx.build(graph, w, "", GroupId::ALL).note(note);
    }
    if let Some(node) = &mut graph.pair {
        node.pair = pair;
    }
    w.touch();
    Ok(Declared::default())
}

/// The sub-style of a `hybrid` that the other words concern.
fn part(parts: &[&str], args: &mut Args) -> Result<()> {
    let word = args.expect("a sub-style")?;
    if !parts.contains(&word.text.as_str()) {
        let text = format!("`{}` is no sub-style of the pair style in force", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
        return Err(match parts {
            [] => d.help("`pair` goes with `pair_style hybrid` only"),
            _ => d.help(format!("there are {}", parts.join(" "))),
        }
        .into());
    }
    Ok(())
}
