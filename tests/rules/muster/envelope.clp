; SPDX-License-Identifier: Apache-2.0
; options: library=no
; The whole envelope: what a handler of a layer sees of its mail, and what it answers with.

(defglobal ?*asked* = nil)

(deffunction show (?mail $?keys)
  (progn$ (?key ?keys)
    (printout t ?key "=" (mail-parameter ?mail ?key) " "))
  (printout t crlf))

(deffunction barter (?id ?from ?performative ?content)
  (show ?id from performative language ontology reply-with in-reply-to conversation layer reply-by)
  (bind ?*asked* ?id)
  (switch ?performative
    (case cfp then (reply-as ?id propose price 10))
    (case query-if then (reply ?id yes))
    (case request then
      (speak agree ?from (create$ later) in-reply-to (mail-parameter ?id reply-with)
             conversation (mail-parameter ?id conversation) layer (mail-parameter ?id layer)))
    (default FALSE)))

(on-layer 4 barter)

(defrule mail-is-here
  ?mail <- (mail (layer 4) (performative inform))
  =>
  (show ?mail from performative language ontology reply-with in-reply-to conversation layer)
  (reply-as ?mail confirm "so be it"))

; layer: 4 cfp q-1 red apples 3
; envelope: conversation=c-1 ontology=fruit reply-by=12.5
; step:
; expect: from=red performative=cfp language=clips ontology=fruit reply-with=q-1 in-reply-to=nil conversation=c-1 layer=4 reply-by=12.5 
; expect: mail red propose ontology=fruit in-reply-to=q-1 conversation=c-1 layer=4 "price 10"
; layer: 4 query-if q-2 red ripe
; envelope: conversation=c-1 in-reply-to=b-7
; step:
; expect: from=red performative=query-if language=clips ontology=nil reply-with=q-2 in-reply-to=b-7 conversation=c-1 layer=4 reply-by=nil 
; expect: mail red tell in-reply-to=q-2 conversation=c-1 layer=4 "yes"
; layer: 4 request q-3 red (+ 1 2)
; envelope: language=lisp conversation=c-2
; step:
; expect: from=red performative=request language=lisp ontology=nil reply-with=q-3 in-reply-to=nil conversation=c-2 layer=4 reply-by=nil 
; expect: mail red agree in-reply-to=q-3 conversation=c-2 layer=4 "later"
;
; What the handler passes on is a fact with the same parameters.
; layer: 4 inform q-4 red eaten
; envelope: conversation=c-3 ontology=fruit
; step:
; expect: from=red performative=inform language=clips ontology=fruit reply-with=q-4 in-reply-to=nil conversation=c-3 layer=4 reply-by=nil 
; expect: from=red performative=inform language=clips ontology=fruit reply-with=q-4 in-reply-to=nil conversation=c-3 layer=4 
; expect: mail red confirm ontology=fruit in-reply-to=q-4 conversation=c-3 layer=4 ""so be it""
;
; Outside of the handler its number is no mail.
; line: (mail-parameter ?*asked* from)
; expect: [MUSTER1] Function mail-parameter expected a mail fact, or in a handler the number of its mail
; expect: FALSE
; expect: refused
; line: (reply-as ?*asked* tell x)
; expect: [MUSTER1] Function reply-as expected a mail fact, or in a handler the number of its mail
; expect: FALSE
; expect: refused
; line: (do-for-fact ((?m mail)) TRUE (mail-parameter ?m colour))
; expect: [MUSTER1] Function mail-parameter expected one of these parameters: from performative language ontology reply-with in-reply-to conversation layer, and in a handler reply-by
; expect: FALSE
; expect: refused
; line: (do-for-fact ((?m mail)) TRUE (mail-parameter ?m reply-by))
; expect: [MUSTER1] Function mail-parameter expected one of these parameters: from performative language ontology reply-with in-reply-to conversation layer, and in a handler reply-by
; expect: FALSE
; expect: refused
; line: (mail-parameter 1)
; expect: [ARGACCES4] Function mail-parameter expected exactly 2 argument(s)
; expect: refused
; line: (reply-as 1)
; expect: [ARGACCES4] Function reply-as expected at least 2 argument(s)
; expect: refused
;
; How long a mail and an offer last; a key that nobody knows is an error.
; line: (speak cfp red (create$ map) ttl 2.5 priority high)
; expect: mail red cfp priority=1 ttl=2.5 "map"
; expect: TRUE
; line: (speak cfp red (create$ map) reply-by 60)
; expect: mail red cfp reply-by=60.0 ttl=59.7 "map"
; expect: TRUE
; line: (speak cfp red (create$ map) reply-by 60 ttl 2)
; expect: mail red cfp reply-by=60.0 ttl=2.0 "map"
; expect: TRUE
; line: (speak cfp red (create$ map) ttl 2 reply-by 60)
; expect: mail red cfp reply-by=60.0 ttl=2.0 "map"
; expect: TRUE
; line: (speak cfp red (create$ map) ttl 0)
; expect: [MUSTER1] Function speak expected a number of seconds above 0 behind ttl
; expect: FALSE
; expect: refused
; line: (speak cfp red (create$ map) tll 2)
; expect: [MUSTER1] Function speak expected pairs of a value and one of these keys: language ontology reply-with in-reply-to reply-by conversation ttl layer priority level
; expect: FALSE
; expect: refused
; line: (advertise maps price 10 lease 60 area 12.5)
; expect: change advertise maps "price=10 area=12.5" lease=60.0
; expect: TRUE
; line: (advertise maps lease 0.5)
; expect: change advertise maps "" lease=0.5
; expect: TRUE
; line: (advertise maps lease -1)
; expect: [MUSTER1] Function advertise expected a number of seconds above 0 behind lease
; expect: FALSE
; expect: refused
; line: (advertise maps lease long)
; expect: [MUSTER1] Function advertise expected a number as argument #3, and got the symbol long
; expect: FALSE
; expect: refused
; line: (advertise maps ttl 60)
; expect: [MUSTER1] Function advertise expected lease in place of ttl, reply-by, lease-time or expires
; expect: FALSE
; expect: refused
; line: (advertise maps "a b" 60)
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
