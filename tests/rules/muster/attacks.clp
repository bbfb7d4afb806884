; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Rules that would end or hold up the process, and what is left when they are stopped.
(deffunction deep (?x) (deep (+ ?x 1)))
(defrule endless (declare (salience 5)) (attack endless) => (while TRUE do (bind ?x 1)))
(defrule recursion (attack deep) => (deep 1))
(defrule hog (attack hog) => (bind ?s "0123456789abcdef") (while TRUE do (bind ?s (str-cat ?s ?s))))
(defrule works (works) => (printout t "works" crlf))

; acts: on
; line: (exit)
; expect: [EXPRNPSR3] Missing function declaration for exit.
; expect: refused
; line: (system "true")
; expect: [EXPRNPSR3] Missing function declaration for system.
; expect: refused
; line: (open "x" f "w")
; expect: [EXPRNPSR3] Missing function declaration for open.
; expect: refused
; line: (load "x")
; expect: [EXPRNPSR3] Missing function declaration for load.
; expect: refused
; line: (batch* "x")
; expect: [EXPRNPSR3] Missing function declaration for batch*.
; expect: refused
; line: (remove "x")
; expect: [EXPRNPSR3] Missing function declaration for remove.
; expect: refused
; line: (clear)
; expect: [EXPRNPSR3] Missing function declaration for clear.
; expect: refused
; line: (eval "(exit)")
; expect: [EXPRNPSR3] Missing function declaration for exit.
; expect: FALSE
; expect: refused
; line: (funcall system "true")
; expect: [ARGACCES5] Function funcall expected argument #1 to be of type function, deffunction, or generic function name
; expect: FALSE
; line: (eval "(+ 1 2)")
; expect: 3
; line: (build "(defrule built (works) (x ?*mate*) =>)") (ppdefrule built)
; expect: TRUE
; expect: (defrule MAIN::built
; expect:    (works)
; expect:    (x ?*mate*)
; expect:    =>)
; line: (bind ?o "(") (loop-for-count (?i 1 12) do (bind ?o (str-cat ?o ?o))) (eval ?o)
; expect: "("
; expect: FALSE
; expect: [MUSTER1] Function eval expected a text that can be parsed, not one with more than 256 nested parentheses
; expect: FALSE
; expect: refused
; line: (assert-string ?o)
; expect: [MUSTER1] Function assert-string expected a text that can be parsed, not one with more than 256 nested parentheses
; expect: FALSE
; expect: refused
; line: (set-strategy random)
; expect: [MUSTER1] Function set-strategy expected depth, breadth, lex, mea, complexity or simplicity
; expect: FALSE
; expect: refused
; line: (set-strategy breadth) (set-strategy depth)
; expect: depth
; expect: breadth
;
; line: (assert (attack endless) (works))
; expect: <Fact-2>
; step:
; expect: rule endless (tests/rules/muster/attacks.clp:5): stopped by the guard for ticks
; expect: stopped ticks, 1 fired, 1 errors: endless
; step:
; expect: works
; expect: idle, 1 fired, 0 errors: works
; line: (assert (attack deep))
; expect: <Fact-7>
; step:
; expect: rule recursion (tests/rules/muster/attacks.clp:6): [MUSTER2] Functions call each other too deeply 
; expect: stopped depth, 1 fired, 1 errors: recursion
; line: (assert (attack hog))
; expect: <Fact-10>
; step:
; expect: rule hog (tests/rules/muster/attacks.clp:7): stopped by the guard for memory
; expect: stopped memory, 1 fired, 1 errors: hog
; step:
; expect: idle, 0 fired, 0 errors:
; line: (while TRUE do (bind ?x 1))
; expect: FALSE
; expect: stopped: the guard for ticks
; expect: refused
; line: (deep 1)
; expect: [MUSTER2] Functions call each other too deeply
; expect: FALSE
; expect: stopped: the guard for depth
; expect: refused
; line: (+ 1 1)
; expect: 2
; line: (read)
; expect: [EXPRNPSR3] Missing function declaration for read.
; expect: refused
; line: (+ 1 2))) junk
; expect: a ')' too many: )
; expect: refused
; line: (+ 1 2) junk
; expect: expected nothing more, or one more form in parentheses: junk
; expect: refused
; line: (+ 1 2
; expect: a parenthesis is never closed: (+ 1 2
; expect: refused
;
; What the fuzzer has found.
; line: (deftemplate t (slot a) (multislot b)) (assert (t (a 1) (b x)))
; expect: <Fact-15>
; line: (modify 15 (a 2) (no-such-slot 3))
; expect: [TMPLTDEF1] Invalid slot no-such-slot not defined in corresponding deftemplate t.
; expect: FALSE
; expect: refused
; line: (send (undeffacts *))
; expect: [MUSTER1] Function send expected an agent to send to
; expect: FALSE
; expect: refused

; An empty text has nothing behind its first letter.
; line: (check-syntax "")
; expect: MISSING-LEFT-PARENTHESIS
