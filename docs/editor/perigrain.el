;;; perigrain.el --- Decks in Emacs 29 and newer, with eglot  -*- lexical-binding: t -*-

;; Copy this file into a folder of `load-path' and say (require 'perigrain).

(defvar perigrain-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?# "<" table)
    (modify-syntax-entry ?\n ">" table)
    (modify-syntax-entry ?\" "\"" table)
    (modify-syntax-entry ?' "\"" table)
    (modify-syntax-entry ?_ "_" table)
    (modify-syntax-entry ?/ "_" table)
    table)
  "Comments, texts and names of decks.")

(defvar perigrain-font-lock
  '(("^[ \t]*\\([a-z_]+\\)" 1 font-lock-keyword-face)
    ("\\${[^}]*}\\|\\_<[vcf]_[A-Za-z0-9_]+" 0 font-lock-variable-name-face))
  "Colours of decks.")

;;;###autoload
(define-derived-mode perigrain-mode prog-mode "perigrain"
  "Decks for perigrain."
  (setq-local comment-start "# ")
  (setq-local font-lock-defaults '(perigrain-font-lock)))

;;;###autoload
(add-to-list 'auto-mode-alist '("/in\\.[^/]*\\'\\|\\.\\(perigrain\\|lmp\\)\\'" . perigrain-mode))

(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs '(perigrain-mode . ("perigrain" "lsp"))))

(add-hook 'perigrain-mode-hook #'eglot-ensure)

(provide 'perigrain)
;;; perigrain.el ends here
