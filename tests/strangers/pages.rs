//! K9: numbers on pages are those that their decks print.
