" Decks by their names.
autocmd BufNewFile,BufRead in.*,*.perigrain,*.lmp set filetype=perigrain
