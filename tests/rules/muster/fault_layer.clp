; SPDX-License-Identifier: Apache-2.0
; options: library=no
; fails: 6 no deffunction trade that takes four arguments
(deffunction trade (?id) TRUE)
; The function is there, but cannot be called with a mail.
(on-layer 4 trade)
