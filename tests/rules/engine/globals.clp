; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; set
(defglobal ?*a* = 1 ?*b* = (+ ?*a* 1))
(defrule r => (printout t ?*a* ?*b* crlf) (bind ?*a* 5) (printout t ?*a* crlf))

;;; multifields
(defglobal ?*m* = (create$ a b))
(defrule r => (bind ?*m* ?*m* c) (printout t ?*m* crlf))

;;; in conditions
(defglobal ?*limit* = 5)
(deffacts f (n 3) (n 7))
(defrule r (n ?x&:(> ?x ?*limit*)) => (printout t ?x crlf))

;;; in tests
(defglobal ?*limit* = 5)
(deffacts f (n 3) (n 7))
(defrule r (n ?x) (test (< ?x ?*limit*)) => (printout t ?x crlf))

;;; back to the first value
(defglobal ?*a* = 1)
(deffunction f () (bind ?*a* 9) (bind ?*a*) ?*a*)
(defrule r => (printout t (f) crlf))
