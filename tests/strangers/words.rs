//! K6: decks and files as strangers write them, and messages that lead somewhere.
