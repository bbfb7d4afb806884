; SPDX-License-Identifier: Apache-2.0
; options: library=no
; A body reads what rules look at, and nothing else; what it reads, in the units of rules.
(deffacts start (want nothing))

; senses:
; expect: senses
; laser: 500 1000 2750
; blob: ff0000 10 5 1500
; blob: 123456 -20 2.5 2000
; blob: ff0000 30 1 3000
; fiducial: 7 45 1200 -90
; fiducial: 0 -45 9000 270
; step: x=100 y=200 heading=90 ox=90 oy=210 oheading=-180
;
; Nobody looks, so nothing is read, and there is no fact.
; line: (findall (position $?))
; expect: (<Fact-2>)
; line: (gps)
; expect: (100.0 200.0 90.0)
; line: (odometer)
; expect: (90.0 210.0 180.0)
;
; A call on a line counts from the next step on.
; line: (laser)
; expect: ()
; line: (laser 0)
; expect: [MUSTER1] Function laser expected the index of a beam that was read, from 0
; expect: FALSE
; expect: refused
; senses:
; expect: senses laser
; step:
; step:
; line: (laser)
; expect: (500.0 1000.0 2750.0)
; line: (laser 1)
; expect: 1000.0
; line: (laser 1 2)
; expect: (1000.0 2750.0)
; line: (laser 2 1)
; expect: ()
; line: (laser 3)
; expect: [MUSTER1] Function laser expected the index of a beam that was read, from 0
; expect: FALSE
; expect: refused
; line: (laser -1 2)
; expect: [MUSTER1] Function laser expected the index of a beam that was read, from 0
; expect: FALSE
; expect: refused
; line: (laser left)
; expect: [ARGACCES5] Function laser expected argument #1 to be of type integer
; expect: refused
; line: (laser 0 1 2)
; expect: [ARGACCES4] Function laser expected no more than 2 argument(s)
; expect: refused
;
; The fact stands for who looks, with the time in front.
; facts: laser
; expect: f-8     (laser 0.2 500.0 1000.0 2750.0)
; expect: For a total of 1 fact.
;
; A pattern is enough, and when its rule goes the sensor is left alone again.
; line: (defrule sees (blob ?t red ?bearing ?width ?range) => (printout t "red " ?bearing " " ?width " " ?range crlf))
; senses:
; expect: senses laser camera
; step:
; step:
; expect: red 30.0 1.0 3000.0
; expect: red 10.0 5.0 1500.0
; line: (undefrule sees)
; senses:
; expect: senses laser
; step:
; facts: blob
; expect: For a total of 0 facts.
;
; line: (deffunction eye () (camera red))
; senses:
; expect: senses laser camera
; step:
; step:
; line: (eye)
; expect: (red 10.0 5.0 1500.0 red 30.0 1.0 3000.0)
; line: (camera)
; expect: (red 10.0 5.0 1500.0 #123456 -20.0 2.5 2000.0 red 30.0 1.0 3000.0)
; line: (camera #123456)
; expect: (#123456 -20.0 2.5 2000.0)
; line: (camera blue)
; expect: ()
; line: (camera 5)
; expect: [ARGACCES5] Function camera expected argument #1 to be of type symbol or string
; expect: refused
;
; line: (findall (fiducial $?))
; expect: ()
; senses:
; expect: senses laser camera fiducials
; line: (fiducials)
; expect: ()
; step:
; step:
; line: (fiducials)
; expect: (7 45.0 1200.0 -90.0 0 -45.0 9000.0 -90.0)
; line: (defrule knows (fiducial ? ?number&~0 ?bearing $?) => (printout t ?number " at " ?bearing crlf))
; step:
; expect: 7 at 45.0
;
; line: (defrule hears (sonar $?) =>)
; senses:
; expect: senses sonar laser camera fiducials
;
; A query in a construct is a look, too.
; line: (undefrule *)
; line: (deffunction far () (any-factp ((?f blob)) TRUE))
; step:
; line: (far)
; expect: TRUE
; line: (undeffunction far)
; step:
; facts: blob
; expect: For a total of 0 facts.
;
; What every body has, or has not.
; line: (bumpers)
; expect: ()
; line: (battery)
; expect: FALSE
; line: (gripper)
; expect: ()
; line: (gripper open)
; expect: FALSE
; line: (undefrule *)
; step: bumpers=145 battery=0.5 gripper=1
; expect: gripper -1 0
; line: (bumpers)
; expect: (0.0 180.0 -45.0)
; line: (battery)
; expect: 0.5
; line: (gripper)
; expect: (open down FALSE FALSE FALSE)
; line: (gripper close)
; expect: TRUE
; line: (gripper lift)
; expect: TRUE
; step: gripper=63
; expect: gripper 1 1
; line: (gripper)
; expect: (closed up TRUE TRUE TRUE)
; line: (gripper lower)
; expect: TRUE
; step:
; expect: gripper 0 -1
; step:
; line: (gripper throw)
; expect: [MUSTER1] Function gripper expected open, close, lift or lower
; expect: FALSE
; expect: refused
; line: (gripper 1)
; expect: [ARGACCES5] Function gripper expected argument #1 to be of type symbol or string
; expect: refused
;
; The laser's intensity is a part of the laser: who looks at it has both.
; list: laser-intensity 1 0.5 0
; senses:
; expect: senses laser camera fiducials
; step:
; line: (laser-intensity)
; expect: ()
; facts: laser-intensity
; expect: For a total of 0 facts.
; line: (defrule shines (laser-intensity ?time ?first $?others) => (printout t ?first " then " $?others crlf))
; senses:
; expect: senses laser camera fiducials laser-intensity
; step:
; step:
; expect: 1.0 then (0.5 0.0)
; line: (laser-intensity 1)
; expect: 0.5
; line: (laser-intensity 1 2)
; expect: (0.5 0.0)
; line: (laser-intensity 3)
; expect: [MUSTER1] Function laser-intensity expected the index of a beam that was read, from 0
; expect: FALSE
; expect: refused
