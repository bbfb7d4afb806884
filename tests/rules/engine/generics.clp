; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; by type
(defmethod kind ((?x INTEGER)) int)
(defmethod kind ((?x FLOAT)) float)
(defmethod kind ((?x LEXEME)) word)
(defrule r => (printout t (kind 1) (kind 1.5) (kind a) (kind "s") crlf))

;;; by condition
(defmethod size ((?x NUMBER (> ?x 100))) big)
(defmethod size ((?x NUMBER)) small)
(defrule r => (printout t (size 5) (size 500) crlf))

;;; next method
(defmethod f ((?x INTEGER)) (str-cat int "-" (call-next-method)))
(defmethod f ((?x NUMBER)) number)
(defrule r => (printout t (f 3) crlf))

;;; wildcards
(defmethod f ($?x) (length$ ?x))
(defrule r => (printout t (f) (f 1 2 3) crlf))

;;; operators
(defmethod + ((?a STRING) (?b STRING)) (str-cat ?a ?b))
(defrule r => (printout t (+ "a" "b") (+ 1 2) crlf))
