//! K5: what an interrupt leaves behind is what `write_restart` writes at that step; all long work sees one stop flag.
