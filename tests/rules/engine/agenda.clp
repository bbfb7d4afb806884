; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; salience
(deffacts f (go))
(defrule a (declare (salience 1)) (go) => (printout t a crlf))
(defrule b (declare (salience 5)) (go) => (printout t b crlf))
(defrule c (go) => (printout t c crlf))

;;; depth
(deffacts f (n 1) (n 2) (n 3))
(defrule r (n ?x) => (printout t ?x crlf))

;;; breadth
(deffacts f (go))
(defrule start (declare (salience 10)) (go) => (set-strategy breadth) (assert (n 1) (n 2) (m 1) (m 2)))
(defrule one (n ?x) => (printout t n ?x crlf))
(defrule two (n ?x) (m ?x) => (printout t nm ?x crlf))
(defrule three (m ?x) (n ?y&~?x) (go) => (printout t mn ?x ?y crlf))

;;; lex
(deffacts f (go))
(defrule start (declare (salience 10)) (go) => (set-strategy lex) (assert (n 1) (n 2) (m 1) (m 2)))
(defrule one (n ?x) => (printout t n ?x crlf))
(defrule two (n ?x) (m ?x) => (printout t nm ?x crlf))
(defrule three (m ?x) (n ?y&~?x) (go) => (printout t mn ?x ?y crlf))

;;; mea
(deffacts f (go))
(defrule start (declare (salience 10)) (go) => (set-strategy mea) (assert (n 1) (n 2) (m 1) (m 2)))
(defrule one (n ?x) => (printout t n ?x crlf))
(defrule two (n ?x) (m ?x) => (printout t nm ?x crlf))
(defrule three (m ?x) (n ?y&~?x) (go) => (printout t mn ?x ?y crlf))

;;; complexity
(deffacts f (go))
(defrule start (declare (salience 10)) (go) => (set-strategy complexity) (assert (n 1) (n 2) (m 1) (m 2)))
(defrule one (n ?x) => (printout t n ?x crlf))
(defrule two (n ?x) (m ?x) => (printout t nm ?x crlf))
(defrule three (m ?x) (n ?y&~?x) (go) => (printout t mn ?x ?y crlf))

;;; simplicity
(deffacts f (go))
(defrule start (declare (salience 10)) (go) => (set-strategy simplicity) (assert (n 1) (n 2) (m 1) (m 2)))
(defrule one (n ?x) => (printout t n ?x crlf))
(defrule two (n ?x) (m ?x) => (printout t nm ?x crlf))
(defrule three (m ?x) (n ?y&~?x) (go) => (printout t mn ?x ?y crlf))

;;; computed salience
(defglobal ?*s* = 7)
(deffacts f (go))
(defrule a (declare (salience ?*s*)) (go) => (printout t a crlf))
(defrule b (declare (salience (+ 4 4))) (go) => (printout t b crlf))

;;; refraction
(deffacts f (a 1))
(defrule r (a ?x) => (printout t once ?x crlf))
(defrule s (declare (salience -1)) ?f <- (a 1) => (retract ?f) (assert (a 2)))

;;; refresh
(deffacts f (a 1))
(defglobal ?*n* = 0)
(defrule r (a ?x) => (printout t fired crlf))
(defrule s (declare (salience -1)) (a 1) => (refresh r))

;;; removed rules
(deffacts f (a))
(defrule s (declare (salience 1)) (a) => (undefrule r))
(defrule r (a) => (printout t never crlf))
(defrule t (declare (salience -1)) (a) => (printout t end crlf))
