; SPDX-License-Identifier: Apache-2.0
;
; Drives straight on and turns away from what is near.  Answers hello with hello.

(defglobal
  ?*near* = 700)  ; mm

; What the robot wants when it starts.
(deffacts beginning
  (goal patrol))

; (patrol) on a console makes it go on; new-goal is the library's and replaces what it wanted.
(deffunction patrol ()
  (new-goal patrol))

(defrule straight-on
  (goal patrol)
  (position ? ?x ?y $?)
  =>
  (setSpeed 300 0)
  (update-sensors)
  (tell-position ?x ?y))

; s3 and s4 look ahead.  More urgent than straight-on: its salience is higher.
(defrule turn-away
  (declare (salience 5))
  (goal patrol)
  (position ? ?x ?y $?)
  (sonar ? ? ? ? ?s3 ?s4 $?)
  (test (< (min ?s3 ?s4) ?*near*))
  =>
  (setSpeed 0 60)
  (update-sensors)
  (tell-position ?x ?y))

; Whatever else it does: a mail fact stays until a rule retracts it.
(defrule be-polite
  (declare (salience 30))
  ?mail <- (mail (content hello $?))
  =>
  (reply ?mail hello from ?*my-name*)
  (retract ?mail))
