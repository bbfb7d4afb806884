; SPDX-License-Identifier: Apache-2.0
; Mail facts and speech acts.
(defrule answer
  ?mail <- (mail (performative ask-one) (from ?who) (content what ?x))
  =>
  (reply ?mail what ?x is (* 2 ?x))
  (retract ?mail))

; speech: ask-one q-7 red what 4
; step:
; expect: mail red tell in-reply-to=q-7 "what 4 is 8"
; line: (findall (mail (from red)))
; expect: ()
; line: (reply 4 x)
; expect: [MUSTER1] Function reply expected a mail fact, or in a handler the number of its mail
; expect: FALSE
; expect: refused
;
; line: (send red hello 1 2.5 1e20 "a \"b\" \\ c" (sym-cat "two words"))
; expect: mail red "hello 1 2.5 1e+20 "a \"b\" \\ c" "two words""
; expect: TRUE
; line: (send red 0.1 100.0 -3)
; expect: mail red "0.10000000000000001 100.0 -3"
; expect: TRUE
; line: (send nobody hello)
; expect: FALSE
; line: (send "not a name" hello)
; expect: [MUSTER1] Function send expected the name of an agent, or several
; expect: FALSE
; expect: refused
; line: (send)
; expect: [ARGACCES4] Function send expected at least 1 argument(s)
; expect: refused
; line: (send red (/ 1e308 1e-10))
; expect: [MUSTER1] Function send expected fields that can be mailed: symbols, strings, finite numbers
; expect: FALSE
; expect: refused
; line: (broadcast mate-pos blue 1 2)
; expect: mail all "mate-pos blue 1 2"
; expect: TRUE
; line: (broadcast)
; expect: mail all ""
; expect: TRUE
; line: (tell red (create$ a b) c)
; expect: mail red tell "a b c"
; expect: TRUE
; line: (ask-one red where)
; expect: mail red ask-one reply-with=blue-1 "where"
; expect: blue-1
; line: (ask-all robots where)
; expect: mail robots ask-all reply-with=blue-2 "where"
; expect: blue-2
; line: (achieve red door open)
; expect: mail red achieve reply-with=blue-3 "door open"
; expect: blue-3
; line: (speak inform red (create$ x 1) ontology maze reply-with q conversation c1)
; expect: mail red inform ontology=maze reply-with=q conversation=c1 "x 1"
; expect: q
; line: (speak inform red "as it is" language plain in-reply-to z reply-by 9.0)
; expect: mail red inform language=plain in-reply-to=z reply-by=9.0 ttl=9.0 "as it is"
; expect: TRUE
; line: (speak inform red x colour blue)
; expect: [MUSTER1] Function speak expected pairs of a value and one of these keys: language ontology reply-with in-reply-to reply-by conversation ttl layer priority level
; expect: FALSE
; expect: refused
; line: (speak inform red x ontology)
; expect: [MUSTER1] Function speak expected a performative, a name, a content and pairs of key, value
; expect: FALSE
; expect: refused
; line: (speak inform red x reply-by 0)
; expect: [MUSTER1] Function speak expected a time in the future behind reply-by
; expect: FALSE
; expect: refused
;
; line: (you-do red wander)
; expect: do red "(wander)"
; expect: TRUE
; line: (you-do (create$ red green) follow blue)
; expect: do red,green "(follow blue)"
; expect: TRUE
; line: (you-do red eval "(exit)" (sym-cat "a) (b"))
; expect: do red "(eval "(exit)" "a) (b")"
; expect: TRUE
; line: (you-do 3 wander)
; expect: [MUSTER1] Function you-do expected a name, a group or a multifield of names, a command, its fields
; expect: FALSE
; expect: refused
; line: (you-do (create$) wander)
; expect: [MUSTER1] Function you-do expected a name, a group or a multifield of names, a command, its fields
; expect: FALSE
; expect: refused
;
; line: (my-name)
; expect: blue
; line: (lookup green)
; expect: (green robot standby there)
; line: (lookup pink)
; expect: FALSE
; line: (lookup 3)
; expect: [ARGACCES5] Function lookup expected argument #1 to be of type symbol or string
; expect: refused
; line: (listing)
; expect: (blue green red)
;
; send with an instance is CLIPS's own.
; line: (defclass POINT (is-a USER) (slot x (create-accessor read-write)))
; line: (make-instance p of POINT (x 4))
; expect: [p]
; line: (send [p] get-x)
; expect: 4
; line: (send (instance-address [p]) put-x 5) (send [p] get-x)
; expect: 5
; expect: 5
; line: (send [p])
; expect: [MUSTER1] Function send expected a message for the instance
; expect: FALSE
; expect: refused
