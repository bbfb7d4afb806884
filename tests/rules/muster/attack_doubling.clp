; SPDX-License-Identifier: Apache-2.0
; options: library=no
; One right-hand side without a loop, and one fact, that want more memory than any machine has.
(defrule double
  (attack)
  =>
  (bind ?a (create$ 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a))
  (bind ?a (create$ ?a ?a ?a ?a ?a ?a ?a ?a ?a ?a)))

(defrule matches (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) =>)

; acts: on
; line: (assert (attack))
; expect: <Fact-1>
; step:
; expect: rule double (tests/rules/muster/attack_doubling.clp:4): stopped by the guard for ticks
; expect: stopped ticks, 1 fired, 1 errors: double
; line: (assert (m 1) (m 2))
; expect: the rules are gone: they wanted more memory than there is for them
; expect: refused
;
; It stays so, whatever comes.
; event: on-run
; refused: group-create north group-exists
; mail: red hello
; step:
; expect: mail refused
; expect: speed 0 0
; expect: stopped memory, 0 fired, 1 errors:
; expect: enough: its rules are gone: memory
; line: (+ 1 1)
; expect: the rules are gone: they wanted more memory than there is for them
; expect: refused
; facts:
; expect: the rules are gone: they wanted more memory than there is for them
; expect: refused
