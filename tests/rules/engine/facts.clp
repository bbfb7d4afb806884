; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; asserted
(defrule r => (assert (a 1)) (assert (b 2) (c 3)))
(defrule s (a ?x) (b ?y) (c ?z) => (printout t ?x ?y ?z crlf))

;;; twice is once
(defrule r => (printout t (assert (a 1)) (assert (a 1)) crlf))

;;; retracted
(deffacts f (a 1) (a 2))
(defrule r ?f <- (a ?x) => (retract ?f) (printout t gone ?x crlf))
(defrule done (declare (salience -1)) (not (a $?)) => (printout t empty crlf))

;;; templates
(deftemplate car (slot color) (slot doors (default 4)) (multislot tags))
(deffacts f (car (color red)) (car (color blue) (doors 2) (tags a b)))
(defrule r (car (color ?c) (doors ?d) (tags $?t)) => (printout t ?c ?d ?t crlf))

;;; modified
(deftemplate p (slot n (default 0)))
(deffacts f (p))
(defrule r ?p <- (p (n ?n&:(< ?n 3))) => (modify ?p (n (+ ?n 1))) (printout t ?n crlf))

;;; duplicated
(deftemplate p (slot n) (slot c))
(deffacts f (p (n 1) (c red)))
(defrule r ?p <- (p (n 1)) => (duplicate ?p (n 2)))
(defrule s (p (n ?n) (c ?c)) => (printout t ?n ?c crlf))

;;; defaults
(deftemplate t (slot a (default ?NONE)) (slot b (type INTEGER)) (slot c (type STRING)) (multislot d))
(deffacts f (t (a 1)))
(defrule r (t (a ?a) (b ?b) (c ?c) (d $?d)) => (printout t ?a "|" ?b "|" ?c "|" ?d "|" crlf))

;;; counted by index
(deffacts f (a) (b) (c))
(defrule r ?f <- (b) => (printout t (fact-index ?f) (fact-existp ?f) (fact-relation ?f) crlf))

;;; slots by name
(deftemplate t (slot a) (multislot b))
(deffacts f (t (a 1) (b x y)))
(defrule r ?f <- (t) => (printout t (fact-slot-value ?f a) (fact-slot-value ?f b) (fact-slot-names ?f) crlf))

;;; from a string
(defrule s => (assert-string "(made 1 two \"three\")"))
(defrule m (made $?x) => (printout t ?x crlf))

;;; queries
(deffacts f (n 1) (n 5) (n 9))
(defrule r => (printout t (any-factp ((?f n)) (> (nth$ 1 ?f:implied) 6)) (length$ (find-all-facts ((?f n)) (> (nth$ 1 ?f:implied) 3))) crlf))

;;; for each
(deftemplate t (slot a))
(deffacts f (t (a 1)) (t (a 2)) (t (a 3)))
(defrule r => (do-for-all-facts ((?f t)) (oddp ?f:a) (printout t ?f:a " ")) (printout t crlf))

;;; pairs
(deftemplate t (slot a))
(deffacts f (t (a 1)) (t (a 2)))
(defrule r => (do-for-all-facts ((?f t) (?g t)) (< ?f:a ?g:a) (printout t ?f:a ?g:a crlf)))

;;; typed slots
(deftemplate t (slot a (type INTEGER)))
(defrule r => (printout t before crlf))
