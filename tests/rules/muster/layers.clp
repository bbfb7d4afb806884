; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Handlers of layers: the child's before the parent's, and what nobody takes.
(extends "parts/shop.clp")

; Gives back what it is offered; the rest is the parent's.
(deffunction thrifty-trade (?id ?from ?performative ?content)
  (if (eq ?performative propose) then
    (send-layer 4 refuse ?from ?content)
   else FALSE))

(on-layer 4 thrifty-trade)

(defrule mail-is-here
  (mail (layer ?layer) (from ?from) (performative ?performative) (content $?content))
  =>
  (printout t "fact " ?layer " " ?from " " ?performative " " ?content crlf))

; layer: 4 propose p-1 red apples 3
; step:
; expect: mail red refuse layer=4 "apples 3"
; layer: 4 cfp p-2 red apples 4
; step:
; expect: shop cfp (apples 4)
; expect: mail red tell in-reply-to=p-2 layer=4 "price 10"
; line: (reply 2 late)
; expect: [MUSTER1] Function reply expected a mail fact, or in a handler the number of its mail
; expect: FALSE
; expect: refused
;
; Nobody has layer 5; nobody knows what this performative means in layer 3; an answer is a fact.
; layer: 5 cfp p-3 red apples 4
; step:
; expect: not understood
; layer: 3 haggle p-4 red apples 4
; step:
; expect: not understood
; layer: 2 sing p-5 red a song
; step:
; expect: not understood
; layer: 5 agree p-6 red yes
; layer: 3 ask-one p-7 red apples
; step:
; expect: fact 3 red ask-one (apples)
; expect: fact 5 red agree (yes)
;
; A handler that passes a mail on leaves it to be a fact; one in layer 3 sees what others send.
; line: (deffunction deaf (?id ?from ?performative ?content) (printout t "deaf " ?id crlf) FALSE)
; line: (on-layer 6 deaf) (on-layer 3 deaf)
; expect: TRUE
; expect: TRUE
; layer: 6 cfp p-8 red pears
; mail: green hello
; step:
; expect: deaf 8
; expect: deaf 9
; expect: fact 3 green nil (hello)
; expect: fact 6 red cfp (pears)
; layer: 3 haggle p-9 red apples
; step:
; expect: deaf 10
; expect: not understood
;
; The youngest first; to say a handler again makes it the youngest.
; line: (deffunction first (?id ?from ?p ?c) (printout t "first" crlf) FALSE)
; line: (deffunction second (?id ?from ?p ?c) (printout t "second" crlf) TRUE)
; line: (on-layer 7 second) (on-layer 7 first)
; expect: TRUE
; expect: TRUE
; layer: 7 tell q red x
; step:
; expect: first
; expect: second
; line: (on-layer 7 second)
; expect: TRUE
; layer: 7 tell q red x
; step:
; expect: second
;
; A function that is defined anew is the handler; one that is gone, or cannot be called, is passed by.
; line: (deffunction second (?id ?from ?p ?c) (printout t "another second" crlf) TRUE)
; layer: 7 tell q red x
; step:
; expect: another second
; line: (deffunction second (?id) TRUE)
; layer: 7 tell q red x
; step:
; expect: first
; expect: fact 7 red tell (x)
; line: (undeffunction first)
; layer: 7 tell q red x
; step:
; expect: fact 7 red tell (x)
;
; A handler that errs has not taken the mail, and says so once.
; line: (deffunction broken (?id ?from ?p ?c) (lookup ?id))
; line: (on-layer 8 broken)
; expect: TRUE
; layer: 8 tell q red x
; layer: 8 tell q red x
; step:
; expect: function broken: [MUSTER1] Function lookup expected a word or a string as argument #1, and got the whole number 16 
; expect: fact 8 red tell (x)
; expect: fact 8 red tell (x)
; line: (deffunction endless (?id ?from ?p ?c) (while TRUE do))
; line: (on-layer 9 endless)
; expect: TRUE
; layer: 9 tell q red x
; step:
; expect: function endless: stopped by the guard for ticks
; expect: fact 9 red tell (x)
;
; What a handler gets outlives it; what it sets is the step's.
; line: (defglobal ?*kept* = nil)
; line: (deffunction keep (?id ?from ?p $?c) (bind ?*kept* ?c) (assert (kept ?id $?c)) (setSpeed 100 0) (update-sensors))
; line: (on-layer 10 keep)
; expect: TRUE
; layer: 10 tell q red a "b" 3.5
; step:
; expect: fact 10 red tell (a "b" 3.5)
; expect: speed 100 0
; line: ?*kept*
; expect: (a "b" 3.5)
; line: (length$ (findall (kept ? a "b" 3.5)))
; expect: 1
;
; line: (on-layer 0 keep)
; expect: [MUSTER1] Function on-layer expected a layer: a whole number from 1 on
; expect: FALSE
; expect: refused
; line: (on-layer 4 nowhere)
; expect: [MUSTER1] Function on-layer expected a deffunction that takes four arguments: id, from, performative, content
; expect: FALSE
; expect: refused
; line: (on-layer high keep)
; expect: [ARGACCES5] Function on-layer expected argument #1 to be of type integer
; expect: refused
; line: (on-layer 4)
; expect: [ARGACCES4] Function on-layer expected exactly 2 argument(s)
; expect: refused
; line: (send-layer 4 cfp red apples 1 2.5) (send-layer 1000 "" group:north) (send-layer 2 facts red)
; expect: mail red cfp reply-with=blue-1 layer=4 "apples 1 2.5"
; expect: mail group:north reply-with=blue-2 layer=1000 ""
; expect: mail red facts reply-with=blue-3 layer=2 ""
; expect: blue-1
; expect: blue-2
; expect: blue-3
; line: (send-layer 0 cfp red)
; expect: [MUSTER1] Function send-layer expected a layer: a whole number from 1 on
; expect: FALSE
; expect: refused
; line: (send-layer 4.5 cfp red)
; expect: [ARGACCES5] Function send-layer expected argument #1 to be of type integer
; expect: refused
; line: (send-layer 4 cfp "a b")
; expect: [MUSTER1] Function send-layer expected the name of an agent, or several
; expect: FALSE
; expect: refused
; line: (send-layer 4 cfp)
; expect: [ARGACCES4] Function send-layer expected at least 3 argument(s)
; expect: refused
