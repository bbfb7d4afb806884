; SPDX-License-Identifier: Apache-2.0
; options: library=no
; A resolver in rules: the agents that SCHEME:REST stands for.

(deftemplate load (slot agent) (slot jobs))

(deffunction least-busy (?rest ?sender)
  (printout t "for " ?rest " asks " ?sender crlf)
  (if (eq ?rest everybody) then
    (return (create$ red green blue)))
  (if (not (numberp ?rest)) then
    (return FALSE))
  (bind ?found (create$))
  (do-for-all-facts ((?l load)) (<= ?l:jobs ?rest)
    (bind ?found (create$ ?found ?l:agent)))
  ?found)

(on-resolve busy least-busy)

(defrule hear-load
  ?mail <- (mail (from ?who) (content load ?jobs))
  =>
  (retract ?mail)
  (do-for-all-facts ((?l load)) (eq ?l:agent ?who) (retract ?l))
  (assert (load (agent ?who) (jobs ?jobs))))

; The offer is made when the file is loaded.
; expect: change resolve busy ""
; mail: blue load 0
; mail: red load 2
; step:
; resolve: 2 green
; expect: for 2 asks green
; expect: red,blue
; resolve: 1.5 green
; expect: for 1.5 asks green
; expect: blue
; resolve: -1 green
; expect: for -1 asks green
; expect: 
; resolve: everybody green
; expect: for everybody asks green
; expect: red,green,blue
; resolve: idle green
; expect: for idle asks green
; expect: no such address
; resolve: 2,3 green
; expect: for 2,3 asks green
; expect: no such address
;
; One name is a name; anything else is an error, and no address.
; line: (deffunction one (?rest ?sender) ?rest)
; line: (on-resolve one one)
; expect: change resolve one ""
; expect: TRUE
; resolve: red green
; expect: red
; resolve: 7 green
; expect: function one: a resolver returns a name, a multifield of names, or FALSE 
; expect: no such address
; line: (deffunction one (?rest ?sender) (create$ red "no name"))
; resolve: red green
; expect: function one: a resolver returns a name, a multifield of names, or FALSE 
; expect: no such address
; line: (deffunction one (?rest ?sender) (lookup ?rest))
; resolve: 3 green
; expect: function one: [MUSTER1] Function lookup expected a word or a string as argument #1, and got the whole number 3 
; expect: no such address
; line: (deffunction one (?rest ?sender) (while TRUE do))
; resolve: red green
; expect: function one: stopped by the guard for ticks
; expect: no such address
;
; A function that can no longer be called is no resolver; what it changed stays.
; line: (deffunction one (?rest ?sender) (assert (asked ?rest)) red)
; resolve: x green
; expect: red
; line: (length$ (findall (asked x)))
; expect: 1
; line: (deffunction one (?rest) red)
; resolve: x green
; expect: no such address
; line: (undeffunction one)
; resolve: x green
; expect: no such address
;
; line: (on-resolve group least-busy)
; expect: [MUSTER1] Function on-resolve expected the name of a scheme, and not group
; expect: FALSE
; expect: refused
; line: (on-resolve "a b" least-busy)
; expect: [MUSTER1] Function on-resolve expected the name of a scheme, and not group
; expect: FALSE
; expect: refused
; line: (on-resolve busy nowhere)
; expect: [MUSTER1] Function on-resolve expected a deffunction that takes two arguments: rest, sender
; expect: FALSE
; expect: refused
; line: (on-resolve busy)
; expect: [ARGACCES4] Function on-resolve expected exactly 2 argument(s)
; expect: refused
