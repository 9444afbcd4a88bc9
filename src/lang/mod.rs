//! Decks as text: words with places, formulas, variables, flow control.
