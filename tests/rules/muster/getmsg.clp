; SPDX-License-Identifier: Apache-2.0
; options: library=no
; (getmsg) where nobody looks at mail facts, and what a rule's pattern makes of that.

; mail: red mate-pos red 1.0 2
; mail: green hello "big \"world\""
; mail: red (+ 1 2)
; mail: red
; text: green plain it's (all) "text"
; step:
; line: (findall (mail))
; expect: ()
; line: (length$ (findall (message $?)))
; expect: 3
; line: (getmsg)
; expect: (red mate-pos red 1.0 2)
; line: (length$ (findall (message $?)))
; expect: 2
; line: (getmsg) (getmsg) (getmsg) (getmsg) (getmsg)
; expect: (green hello "big "world"")
; expect: (red "(+ 1 2)")
; expect: (red)
; expect: (green "it's (all) "text"")
; expect: ()
; line: (getmsg 1)
; expect: [ARGACCES4] Function getmsg expected exactly 0 argument(s)
; expect: refused
;
; From now on a rule waits for questions: they become facts, what fits no pattern does not.
; line: (defrule wait (ready) (mail (performative ask-one)) =>)
; mail: red first
; speech: ask-one q-1 red what 4
; mail: red last
; step:
; line: (length$ (findall (mail)))
; expect: 1
; line: (getmsg) (getmsg) (getmsg) (getmsg)
; expect: (red first)
; expect: (red what 4)
; expect: (red last)
; expect: ()
; line: (findall (mail))
; expect: ()
;
; A function that looks at mail facts makes each a fact.
; line: (deffunction count-mail () (length$ (findall (mail (from red)))))
; mail: red first
; mail: green second
; step:
; line: (count-mail)
; expect: 1
; line: (do-for-all-facts ((?m mail)) TRUE (printout t ?m:content crlf))
; expect: (first)
; expect: (second)
; line: (undefrule wait) (undeffunction count-mail) (getmsg) (getmsg)
; expect: (red first)
; expect: (green second)
; mail: red third
; step:
; line: (findall (mail))
; expect: ()
;
; So does a fact query.
; line: (deffunction any-mail () (any-factp ((?m mail)) TRUE))
; mail: red fourth
; step:
; line: (any-mail)
; expect: TRUE
; line: (getmsg) (getmsg) (any-mail)
; expect: (red third)
; expect: (red fourth)
; expect: FALSE
