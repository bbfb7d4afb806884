; SPDX-License-Identifier: Apache-2.0
; options: library=no
; A rule goes while facts block it: what it shares with other rules stays.
(defrule blocked (a ?x) (not (b ?x)) => (printout t "blocked " ?x crlf))
(defrule nested (a ?x) (not (and (c ?x) (d ?x))) => (printout t "nested " ?x crlf))
(defrule shares (a ?x) (not (b ?x)) (e) => (printout t "shares " ?x crlf))
(defrule both (a ?x) (exists (c ?y) (not (d ?y))) => (printout t "both " ?x crlf))
; line: (assert (a 1) (b 1) (c 1) (d 1) (e))
; expect: <Fact-5>
; line: (undefrule blocked)
; line: (undefrule nested)
; line: (undefrule both)
; line: (retract 2)
; line: (agenda)
; expect: 0      shares: f-1,*,f-5
; expect: For a total of 1 activation.
; line: (undefrule shares)
; line: (agenda)
; line: (facts)
; expect: f-0     (initial-fact)
; expect: f-1     (a 1)
; expect: f-3     (c 1)
; expect: f-4     (d 1)
; expect: f-5     (e)
; expect: For a total of 5 facts.
