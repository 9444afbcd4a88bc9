//! Everything a deck can name: pair styles, fixes, computes, regions, dumps, commands.
