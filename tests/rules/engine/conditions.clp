; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; joined
(deffacts f (father a b) (father b c) (father c d))
(defrule r (father ?x ?y) (father ?y ?z) => (printout t ?x " " ?z crlf))

;;; not
(deffacts f (n 1) (n 2) (bad 2))
(defrule r (n ?x) (not (bad ?x)) => (printout t ?x crlf))

;;; exists
(deffacts f (n 1) (n 2))
(defrule r (exists (n ?)) => (printout t once crlf))

;;; forall
(deffacts f (n 1) (n 2) (ok 1) (ok 2))
(defrule r (forall (n ?x) (ok ?x)) => (printout t all crlf))

;;; or
(deffacts f (a 1) (b 2))
(defrule r (or (a ?x) (b ?x)) => (printout t ?x crlf))

;;; nested
(deffacts f (a 1) (b 1) (c 2))
(defrule r (a ?x) (or (and (b ?x) (c ?)) (d ?x)) => (printout t both crlf))

;;; not and
(deffacts f (a 1) (b 1))
(defrule r (a ?x) (not (and (b ?x) (c ?x))) => (printout t free crlf))

;;; values
(deffacts f (c red) (c blue) (c green))
(defrule r (c red|blue) => (printout t either crlf))
(defrule s (c ~red&~blue) => (printout t other crlf))

;;; bound
(deffacts f (p 1 2) (p 3 3))
(defrule r (p ?x ~?x) => (printout t differ crlf))
(defrule s (p ?x ?x) => (printout t same crlf))

;;; computed
(deffacts f (n 2) (n 4))
(defrule r (n ?x) (n ?y&=(* ?x 2)) => (printout t ?x ?y crlf))

;;; logical
(deffacts f (a))
(defrule r (logical (a)) => (assert (b)))
(defrule s (declare (salience -1)) ?f <- (a) (b) => (retract ?f))
(defrule t (declare (salience -2)) (not (b)) => (printout t gone crlf))

;;; initial fact
(defrule r (initial-fact) => (printout t began crlf))

;;; fact addresses
(deffacts f (a 1))
(defrule r ?f <- (a ?) => (printout t (fact-index ?f) crlf))

;;; tests alone
(defrule r (test (> 2 1)) => (printout t true crlf))
