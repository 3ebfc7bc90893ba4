;;; yarc-mode.el --- Robot programs in YARC  -*- lexical-binding: t; -*-

;; Version: 0.1.0
;; Package-Requires: ((emacs "28.1") (eglot "1.8"))
;; Keywords: languages

;;; Commentary:

;; Colours, and the language server `yarc lsp' by Eglot:
;;
;;   (add-to-list 'load-path "/path/to/editors/emacs")
;;   (require 'yarc-mode)
;;   (add-hook 'yarc-mode-hook #'eglot-ensure)

;;; Code:

(defgroup yarc nil
  "Robot programs in YARC."
  :group 'languages)

(defcustom yarc-program "yarc"
  "Where the program yarc is."
  :type 'string)

(defcustom yarc-robot nil
  "The robot of programs that name none, where no yarc.toml does."
  :type '(choice (const :tag "None" nil) string))

(defvar yarc-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?! "<" table)
    (modify-syntax-entry ?\n ">" table)
    (modify-syntax-entry ?_ "w" table)
    (modify-syntax-entry ?\" "\"" table)
    table)
  "Comments begin with `!'.")

(defvar yarc-font-lock-keywords
  '(("^\\s-*\\(P[0-9]+\\)\\_>" 1 font-lock-constant-face)
    ("^\\s-*P[0-9]+\\s-+\\([A-Z][A-Z0-9_]*\\)" 1 font-lock-function-name-face)
    ("^\\s-*\\([A-Z][A-Z_]*\\)\\_>" 1 font-lock-keyword-face)
    ("{[^{}!\"\n]*}" . font-lock-type-face)
    ("\\$[A-Z_][A-Z0-9_.]*" . font-lock-variable-name-face))
  "What stands where; the server colours more exactly.")

;;;###autoload
(define-derived-mode yarc-mode prog-mode "YARC"
  "Robot programs in YARC."
  (setq-local comment-start "! "
              comment-start-skip "!+\\s-*"
              indent-tabs-mode nil
              tab-width 2
              compile-command (format "yarcc %s" (if buffer-file-name
                                                     (shell-quote-argument buffer-file-name)
                                                   ""))
              font-lock-defaults '(yarc-font-lock-keywords nil t)))

(defun yarc-server (&rest _)
  "How the language server is started."
  (append (list yarc-program "lsp")
          (and yarc-robot (list "--robot" yarc-robot))))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.yarc\\'" . yarc-mode))

(defvar eglot-server-programs)
(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs '(yarc-mode . yarc-server)))

(provide 'yarc-mode)
;;; yarc-mode.el ends here
