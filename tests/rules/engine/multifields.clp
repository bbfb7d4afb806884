; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; made
(defrule r
  =>
  (printout t (create$) crlf)
  (printout t (create$ a b c) crlf)
  (printout t (create$ (create$ a b) (create$) c) crlf)
  (printout t (length$ (create$ a b)) crlf))

;;; taken
(defrule r
  =>
  (printout t (nth$ 2 (create$ a b c)) crlf)
  (printout t (nth$ 9 (create$ a)) crlf)
  (printout t (first$ (create$ a b)) crlf)
  (printout t (rest$ (create$ a b c)) crlf)
  (printout t (first$ (create$)) crlf))

;;; changed
(defrule r
  =>
  (printout t (insert$ (create$ a b) 2 x y) crlf)
  (printout t (delete$ (create$ a b c d) 2 3) crlf)
  (printout t (replace$ (create$ a b c) 2 2 x y) crlf))

;;; searched
(defrule r
  =>
  (printout t (member$ b (create$ a b c)) crlf)
  (printout t (member$ (create$ b c) (create$ a b c)) crlf)
  (printout t (member$ z (create$ a)) crlf)
  (printout t (subsetp (create$ a) (create$ a b)) crlf))

;;; parts
(defrule r
  =>
  (printout t (subseq$ (create$ a b c d) 2 3) crlf)
  (printout t (subseq$ (create$ a b) 5 6) crlf)
  (printout t (delete-member$ (create$ a b a c) a) crlf)
  (printout t (replace-member$ (create$ a b a) x a) crlf))

;;; sorted
(defrule r
  =>
  (printout t (sort > 3 1 2) crlf)
  (printout t (sort < 3 1 2) crlf)
  (printout t (sort > (create$ 5 2.5 4)) crlf))

;;; sorted by length
(deffunction longer (?a ?b) (> (str-length ?a) (str-length ?b)))
(defrule r => (printout t (sort longer ccc a bb) crlf))

;;; each one
(defrule r => (progn$ (?f (create$ a b c)) (printout t ?f-index ":" ?f " ")) (printout t crlf))

;;; foreach
(defrule r => (foreach ?f (create$ a b c) (printout t ?f-index ?f " ")) (printout t crlf))

;;; expanded
(deffunction count ($?x) (length$ ?x))
(defrule r => (bind ?m (create$ a b c)) (printout t (count (expand$ ?m) d) " " (count) crlf))

;;; in patterns
(deffacts f (l a b c) (l) (l x))
(defrule r (l ?first $?rest) => (printout t ?first "|" ?rest crlf))
(defrule e (l) => (printout t empty crlf))

;;; split in patterns
(deffacts f (l a b c))
(defrule r (l $?before ?x $?after) => (printout t ?before " " ?x " " ?after crlf))
