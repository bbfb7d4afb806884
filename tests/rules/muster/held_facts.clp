; SPDX-License-Identifier: Apache-2.0
; options: library=no
; A retracted fact stays while an argument, a list that is being made or a query still holds it.
(deftemplate x (slot n))
(deffunction forget () (do-for-all-facts ((?f x)) TRUE (retract ?f)) gone)
(defclass LISTENER (is-a USER) (role concrete))
(defmessage-handler LISTENER hear ($?held) (forget) (fact-existp (nth$ 1 ?held)))
(deffunction wildcard ($?held) (forget) (assert (held $?held)))
(deffunction parameter (?held) (forget) (fact-existp ?held))
(defgeneric method)
(defmethod method (?held) (forget) (fact-existp ?held))
(deffunction nested () (do-for-all-facts ((?f x)) TRUE (forget)))
(deffunction last-of-loop (?n) (loop-for-count ?n (bind ?f (assert (x (n 1)))) (retract ?f)) ?f)
(deffunction loops (?n) (loop-for-count ?n (retract (assert (x (n 1))))) (last-of-loop ?n))
; line: (wildcard (assert (x (n 1))))
; expect: <Fact-2>
; line: (facts)
; expect: f-0     (initial-fact)
; expect: f-2     (held <Fact-1>)
; expect: For a total of 2 facts.
; line: (parameter (assert (x (n 2))))
; expect: FALSE
; line: (method (assert (x (n 3))))
; expect: FALSE
; line: (make-instance l of LISTENER)
; expect: [l]
; line: (send [l] hear (assert (x (n 4))))
; expect: FALSE
; line: (create$ (assert (x (n 5))) (forget))
; expect: (<Fact-6> gone)
; line: (assert (x (n 6)) (x (n 7)) (x (n 8)))
; expect: <Fact-9>
; line: (nested)
; expect: gone
; line: (facts)
; expect: f-0     (initial-fact)
; expect: f-2     (held <Fact-1>)
; expect: For a total of 2 facts.

; Facts of a loop go with its turns: all of them need more memory than there is.
; line: (loops 300000)
; expect: <Fact-600009>
; line: (facts)
; expect: f-0     (initial-fact)
; expect: f-2     (held <Fact-1>)
; expect: For a total of 2 facts.
