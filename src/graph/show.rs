//! The graph as a drawing for graphviz.

use super::node::Graph;
use super::record::Role;
use std::fmt::Write;

/// The graph in the `dot` language: one box per line of the deck, arrows to what it uses.
pub fn dot(graph: &Graph) -> String {
    let mut s =
        String::from("digraph deck {\n  rankdir=LR;\n  node [fontname=\"monospace\", fontsize=10];\n");
    let nodes = graph.lines.nodes();
    for ((k, n), from) in nodes.iter().enumerate().zip(graph.lines.edges()) {
        let shape = match n.role {
            Role::Declare => "box",
            Role::Act => "ellipse",
            Role::Run => "doubleoctagon",
        };
        let text: String = n.text.split_whitespace().collect::<Vec<_>>().join(" ");
        let label = text.replace('\\', "\\\\").replace('"', "\\\"");
        let _ = writeln!(s, "  n{k} [shape={shape}, label=\"{label}\"];");
        for from in from {
            let _ = writeln!(s, "  n{} -> n{k};", from.0);
        }
    }
    // Runs follow one another and the acts before them.
    let order: Vec<usize> =
        nodes.iter().enumerate().filter(|(_, n)| n.role != Role::Declare).map(|(k, _)| k).collect();
    for pair in order.windows(2) {
        let _ = writeln!(s, "  n{} -> n{} [style=dotted];", pair[0], pair[1]);
    }
    s.push_str("}\n");
    s
}
