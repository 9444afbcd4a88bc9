-- Decks in Neovim 0.11 and newer: copy this file to ~/.config/nvim/plugin/perigrain.lua, and the folder `vim` beside it for colours.
if not (vim.lsp and vim.lsp.config and vim.filetype and vim.filetype.add) then
  vim.api.nvim_echo({ {
    'perigrain.lua: messages, completion and help need Neovim 0.11 or newer; colours (docs/editor/vim) work in this one',
    'WarningMsg',
  } }, true, {})
  return
end

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
