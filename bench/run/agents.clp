; SPDX-License-Identifier: Apache-2.0
;
; An agent of make bench-agents: a timer of a second, and with each stroke a mail to the next one.

(defglobal
  ?*count* = 1000
  ?*heard* = 0)

(deffunction next ()
  (bind ?at (str-index "_" (my-name)))
  (bind ?number (string-to-field (sub-string (+ ?at 1) (str-length (my-name)) (my-name))))
  (sym-cat w_ (mod (+ ?number 1) ?*count*)))

(deffunction stroke ()
  (send (next) stroke))

(defrule begin
  (event on-run)
  =>
  (every 1 "(stroke)"))

(defrule hear
  ?mail <- (mail (content stroke))
  =>
  (retract ?mail)
  (bind ?*heard* (+ ?*heard* 1)))
