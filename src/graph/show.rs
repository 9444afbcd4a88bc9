//! The graph as a drawing for graphviz.

use super::node::{Graph, Role};
use std::fmt::Write;

/// The graph in the `dot` language: one box per line of the deck, arrows to what it uses.
pub fn dot(graph: &Graph) -> String {
    let mut s =
        String::from("digraph deck {\n  rankdir=LR;\n  node [fontname=\"monospace\", fontsize=10];\n");
    for (k, n) in graph.nodes.iter().enumerate() {
        let shape = match n.role {
            Role::Declare => "box",
            Role::Act => "ellipse",
            Role::Run => "doubleoctagon",
        };
        let text: String = n.text.split_whitespace().collect::<Vec<_>>().join(" ");
        let label = text.replace('\\', "\\\\").replace('"', "\\\"");
        let _ = writeln!(s, "  n{k} [shape={shape}, label=\"{label}\"];");
        for wanted in &n.uses {
            let earlier = graph.nodes[..k].iter().rposition(|m| m.provides.as_ref() == Some(wanted));
            if let Some(from) = earlier {
                let _ = writeln!(s, "  n{from} -> n{k};");
            }
        }
    }
    // Runs follow one another and the acts before them.
    let order: Vec<usize> =
        graph.nodes.iter().enumerate().filter(|(_, n)| n.role != Role::Declare).map(|(k, _)| k).collect();
    for pair in order.windows(2) {
        let _ = writeln!(s, "  n{} -> n{} [style=dotted];", pair[0], pair[1]);
    }
    s.push_str("}\n");
    s
}
