; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; sieve
(deffacts f (limit 30) (n 2))
(defrule count (declare (salience 10)) (limit ?l) (n ?x&:(< ?x ?l)) => (assert (n (+ ?x 1))))
(defrule strike (n ?x) ?f <- (n ?y&:(> ?y ?x)&:(= (mod ?y ?x) 0)) => (retract ?f))
(defrule show (declare (salience -10)) (n ?x) => (printout t ?x crlf))

;;; bubble sort
(deffacts f (list 5 3 8 1 9 2))
(defrule swap ?f <- (list $?a ?x ?y&:(< ?y ?x) $?b) => (retract ?f) (assert (list ?a ?y ?x ?b)))
(defrule done (declare (salience -1)) (list $?l) => (printout t ?l crlf))

;;; hanoi
(defglobal ?*moves* = 0)
(deffunction hanoi (?n ?a ?b ?c) (if (> ?n 0) then (hanoi (- ?n 1) ?a ?c ?b) (bind ?*moves* (+ ?*moves* 1)) (hanoi (- ?n 1) ?c ?b ?a)))
(defrule r => (hanoi 8 a b c) (printout t ?*moves* crlf))

;;; family
(deffacts f (parent ann bob) (parent bob cid) (parent bob dan) (parent ann eve))
(defrule ancestor (parent ?a ?b) => (assert (anc ?a ?b)))
(defrule further (anc ?a ?b) (parent ?b ?c) => (assert (anc ?a ?c)))
(defrule sib (parent ?p ?a) (parent ?p ?b&:(< (str-compare ?a ?b) 0)) => (printout t ?a " " ?b crlf))
(defrule show (declare (salience -1)) (anc ann ?x) => (printout t ann " " ?x crlf))

;;; shortest ways
(deffacts f (edge a b 4) (edge a c 1) (edge c b 2) (edge b d 5) (far a 0))
(defrule reach (far ?x ?d) (edge ?x ?y ?w) => (assert (far ?y (+ ?d ?w))))
(defrule less ?f <- (far ?x ?d) (far ?x ?e&:(< ?e ?d)) => (retract ?f))
(defrule show (declare (salience -5)) (far ?x ?d) => (printout t ?x ?d crlf))

;;; state machine
(deffacts f (state idle) (input coin push push coin coin push))
(defrule open ?s <- (state idle) ?i <- (input coin $?r) => (retract ?s ?i) (assert (state open) (input ?r)) (printout t open crlf))
(defrule pass ?s <- (state open) ?i <- (input push $?r) => (retract ?s ?i) (assert (state idle) (input ?r)) (printout t pass crlf))
(defrule ignore (declare (salience -1)) ?i <- (input ?x $?r) => (retract ?i) (assert (input ?r)) (printout t ignored ?x crlf))

;;; queens
(deffunction safe (?c ?r $?q) (bind ?ok TRUE) (progn$ (?o ?q) (if (or (= ?o ?r) (= (abs (- ?o ?r)) (- ?c ?o-index))) then (bind ?ok FALSE))) ?ok)
(deffunction place (?c $?q) (if (> ?c 6) then (return ?q)) (loop-for-count (?r 1 6) do (if (safe ?c ?r ?q) then (bind ?s (place (+ ?c 1) ?q ?r)) (if ?s then (return ?s)))) FALSE)
(defrule r => (printout t (place 1) crlf))

;;; counting words
(deffacts f (text a b a c b a))
(defrule take (declare (salience 1)) ?t <- (text ?w $?r) (not (count ?w ?)) => (retract ?t) (assert (text ?r) (count ?w 1)))
(defrule again ?t <- (text ?w $?r) ?c <- (count ?w ?n) => (retract ?t ?c) (assert (text ?r) (count ?w (+ ?n 1))))
(defrule show (declare (salience -1)) (text) (count ?w ?n) => (printout t ?w ?n crlf))
