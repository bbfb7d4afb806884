; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; if
(defrule r => (if (> 2 1) then (printout t yes crlf) else (printout t no crlf)) (if (> 1 2) then (printout t yes crlf)))

;;; while
(defrule r => (bind ?i 0) (while (< ?i 5) do (printout t ?i " ") (bind ?i (+ ?i 1))) (printout t crlf))

;;; loop for count
(defrule r => (loop-for-count (?i 3 6) do (printout t ?i " ")) (loop-for-count 2 (printout t "x ")) (printout t crlf))

;;; break
(defrule r => (loop-for-count (?i 1 9) do (if (= ?i 4) then (break)) (printout t ?i " ")) (printout t crlf))

;;; switch
(deffunction s (?x) (switch ?x (case 1 then one) (case 2 then two) (default many)))
(defrule r => (printout t (s 1) (s 2) (s 3) crlf))

;;; return
(deffunction f (?x) (if (< ?x 0) then (return negative)) positive)
(defrule r => (printout t (f -1) " " (f 1) crlf))

;;; progn
(defrule r => (printout t (progn (bind ?a 3) (+ ?a 1)) crlf))

;;; recursion
(deffunction fact (?n) (if (<= ?n 1) then 1 else (* ?n (fact (- ?n 1)))))
(defrule r => (printout t (fact 15) crlf))

;;; fibonacci
(deffunction fib (?n) (if (< ?n 2) then ?n else (+ (fib (- ?n 1)) (fib (- ?n 2)))))
(defrule r => (printout t (fib 15) crlf))

;;; functions that call later ones
(deffunction odd (?n))
(deffunction even (?n) (if (= ?n 0) then TRUE else (odd (- ?n 1))))
(deffunction odd (?n) (if (= ?n 0) then FALSE else (even (- ?n 1))))
(defrule r => (printout t (even 10) (odd 10) crlf))

;;; wildcard arguments
(deffunction f (?a $?b) (str-cat ?a "-" (implode$ ?b)))
(defrule r => (printout t (f 1) " " (f 1 2 3) crlf))

;;; funcall
(deffunction twice (?x) (* 2 ?x))
(defrule r => (printout t (funcall + 1 2 3) " " (funcall twice 4) crlf))

;;; logic
(defrule r => (printout t (and TRUE FALSE) (or FALSE TRUE) (not FALSE) (and 1 2) crlf))

;;; halt
(deffacts f (n 1) (n 2) (n 3))
(defrule r (n ?x) => (printout t ?x crlf) (if (= ?x 2) then (halt)))
