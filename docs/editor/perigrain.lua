-- Decks in Neovim 0.11 and newer: copy this file to ~/.config/nvim/plugin/perigrain.lua.
vim.filetype.add({
  extension = { perigrain = 'perigrain', lmp = 'perigrain' },
  pattern = { ['.*/in%.[^/]*'] = 'perigrain' },
})

vim.lsp.config('perigrain', {
  cmd = { vim.env.PERIGRAIN or 'perigrain', 'lsp' },
  filetypes = { 'perigrain' },
})
vim.lsp.enable('perigrain')

vim.api.nvim_create_autocmd('FileType', {
  pattern = 'perigrain',
  callback = function()
    vim.bo.commentstring = '# %s'
  end,
})
