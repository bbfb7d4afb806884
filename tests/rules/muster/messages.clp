; SPDX-License-Identifier: Apache-2.0
; Message facts: how long they stay, and what replaces them.
(deffunction messages ()
  (progn$ (?m (findall (message $?)))
    (printout t (fact-fields ?m) crlf)))

; Because of this function every mail is a mail fact, too.
(deffunction drop-mail ()
  (progn$ (?m (findall (mail)))
    (retract ?m)))

; mail: red mate-pos red 1.0 2.0
; mail: red hello "big \"world\"" 7
; mail: green mate-pos green 3.0 4.0
; step:
; line: (messages)
; expect: (mate-pos red 1.0 2.0)
; expect: (hello "big "world"" 7)
; expect: (mate-pos green 3.0 4.0)
;
; A later step's mail of the same sender with the same first word replaces; others stay.
; mail: red mate-pos red 5.0 6.0
; step:
; line: (messages)
; expect: (hello "big "world"" 7)
; expect: (mate-pos green 3.0 4.0)
; expect: (mate-pos red 5.0 6.0)
;
; Two of one step both stay; two senders that say the same have a fact each.
; mail: red hello again
; mail: red hello once
; mail: green hello once
; step:
; line: (messages)
; expect: (mate-pos green 3.0 4.0)
; expect: (mate-pos red 5.0 6.0)
; expect: (hello again)
; expect: (hello once)
; expect: (hello once)
;
; (getmsg) takes the oldest mail, and its message fact with it.
; line: (getmsg)
; expect: (red mate-pos red 1.0 2.0)
; line: (getmsg)
; expect: (red hello "big "world"" 7)
; line: (getmsg)
; expect: (green mate-pos green 3.0 4.0)
; line: (messages)
; expect: (mate-pos red 5.0 6.0)
; expect: (hello again)
; expect: (hello once)
; expect: (hello once)
; line: (length$ (findall (mail))) (drop-mail) (getmsg)
; expect: 4
; expect: ()
;
; 50 steps old, they go: this is what is left of step 2 and 3.
; steps: 48
; line: (messages)
; expect: (mate-pos red 5.0 6.0)
; expect: (hello again)
; expect: (hello once)
; expect: (hello once)
; step:
; line: (messages)
; expect: (hello again)
; expect: (hello once)
; expect: (hello once)
; step:
; line: (messages)
; expect: FALSE
;
; An equal one is asserted anew.
; mail: red same
; step:
; mail: red same
; step:
; line: (length$ (findall (message same)))
; expect: 1
;
; What is no list of fields is a mail all the same, and so is another language.
; mail: red (+ 1 2)
; mail: red
; text: green plain it's (all) "text"
; step:
; line: (messages)
; expect: (same)
; expect: ()
; line: (getmsg) (getmsg) (getmsg) (getmsg) (getmsg)
; expect: (red same)
; expect: (red same)
; expect: (red "(+ 1 2)")
; expect: (red)
; expect: (green "it's (all) "text"")
