//! What leaves the program: logs, tables, dumps, pictures.
