; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Thirty patterns and two facts: the second one completes 2^30 matches at once.
(defrule all
  (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?)
  (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?)
  (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?)
  =>)

; acts: on
; line: (assert (m 1))
; expect: <Fact-1>
; line: (assert (m 2))
; expect: the rules are gone: they wanted more memory than there is for them
; expect: refused
; step:
; expect: speed 0 0
; expect: stopped memory, 0 fired, 1 errors:
; expect: enough: its rules are gone: memory
