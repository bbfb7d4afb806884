; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Each function of the body and of arithmetic, called right and wrong.
; line: (position)
; expect: ()
; line: (gps)
; expect: ()
; step: x=1000 y=-2000 heading=90 speed=250 turn=-10 s0=400 s15=123
; line: (position)
; expect: (0.0 1000.0 -2000.0 250.0 -10.0 90.0 FALSE)
; line: (gps)
; expect: (1000.0 -2000.0 90.0)
; line: (stalled)
; expect: FALSE
; line: (nth$ 1 (sonar)) (length$ (sonar)) (integer (sonar 15)) (integer (sonar 1))
; expect: 400.000005960464
; expect: 16
; expect: 123
; expect: 5000
; line: (sonar 16)
; expect: [MUSTER1] Function sonar expected the index of a sonar that the body has, from 0
; expect: FALSE
; expect: refused
; line: (sonar x)
; expect: [ARGACCES5] Function sonar expected argument #1 to be of type integer
; expect: refused
; line: (sonar-data 900 400) (sonar-data 100) (sonar-data 9000) (sonar-data (create$ 700 300) 400)
; expect: 150.0
; expect: 0.0
; expect: 500.0
; expect: 50.0
; line: (sonar-data red)
; expect: [MUSTER1] Function sonar-data expected ranges in mm
; expect: 0.0
; expect: refused
; line: (sonar-data)
; expect: [ARGACCES4] Function sonar-data expected at least 1 argument(s)
; expect: refused
; line: (bind ?*sonar-margin* 100) (bind ?*sonar-clip* 700) (sonar-data 9000) (sonar-data 150)
; expect: 100
; expect: 700
; expect: 700.0
; expect: 50.0
; line: (speed-to 0 0 0 2000 0)
; expect: (450.0 0.0)
; line: (speed-to 0 0 0 1000 0)
; expect: (0.0 0.0)
; line: (speed-to 0 0 0 0 2000)
; expect: (0.0 80.0)
; line: (speed-to 0 0 0 0)
; expect: [ARGACCES4] Function speed-to expected exactly 5 argument(s)
; expect: refused
; line: (setSpeed 300 -20)
; expect: TRUE
; step:
; expect: speed 300 -20
; line: (setSpeed 9000 -9000)
; expect: TRUE
; step: stalled=1
; expect: speed 500 -90
; line: (stalled) (setSpeed 100 0) (stop)
; expect: TRUE
; expect: TRUE
; expect: TRUE
; step:
; expect: speed 0 0
; line: (setSpeed (/ 1e308 1e-10) 0)
; expect: [MUSTER1] Function setSpeed expected finite numbers: a speed in mm/s and a turn rate in deg/s
; expect: FALSE
; expect: refused
; line: (setSpeed fast 0)
; expect: [ARGACCES5] Function setSpeed expected argument #1 to be of type integer or float
; expect: refused
; line: (setSpeed 1)
; expect: [ARGACCES4] Function setSpeed expected exactly 2 argument(s)
; expect: refused
; line: (now) (time)
; expect: 0.3
; expect: 0.3
;
; line: (round (* 1000 (sind 30))) (round (* 1000 (cosd 60))) (round (* 1000 (tand 45)))
; expect: 500
; expect: 500
; expect: 1000
; line: (round (asind 1)) (round (acosd 0)) (round (atand 1)) (round (atan2d 1 -1)) (atan2d 0 -1)
; expect: 90
; expect: 90
; expect: 45
; expect: 135
; expect: 180.0
; line: (asind 2)
; expect: [MUSTER1] Function asind expected a number that it has a value for
; expect: 0.0
; expect: refused
; line: (norm-angle 270) (norm-angle -180) (norm-angle 540) (norm-angle 180)
; expect: -90.0
; expect: 180.0
; expect: 180.0
; expect: 180.0
; line: (distance 0 0 3 4) (bearing 0 0 0 5) (bearing 1 1 0 1)
; expect: 5.0
; expect: 90.0
; expect: 180.0
; line: (distance 0 0 3)
; expect: [ARGACCES4] Function distance expected exactly 4 argument(s)
; expect: refused
; line: (clamp 5 1 3) (clamp 0.5 1 3) (clamp 2 1 3)
; expect: 3
; expect: 1.0
; expect: 2
; line: (clamp 5 3 1)
; expect: [MUSTER1] Function clamp expected a number, a lower and an upper limit
; expect: 0.0
; expect: refused
; line: (seed 7) (bind ?a (create$ (random) (random 1 6) (random 5 5))) (seed 7)
; expect: TRUE
; expect: (1037564469 6 5)
; expect: TRUE
; line: (eq ?a (create$ (random) (random 1 6) (random 5 5)))
; expect: TRUE
; line: (random 2 1)
; expect: [MUSTER1] Function random expected a least number that is not above the greatest
; expect: 0
; expect: refused
; line: (random 2)
; expect: [MUSTER1] Function random expected no argument or two: the least and the greatest number
; expect: 0
; expect: refused
; line: (<= -9223372036854775807 (random -9223372036854775808 9223372036854775807))
; expect: TRUE
; line: (div 17 5) (div 100 3 3) (div -7 2) (mod 17 5) (mod -7 3) (mod 7.5 2)
; expect: 3
; expect: 11
; expect: -3
; expect: 2
; expect: -1
; expect: 1.5
; line: (mod -9223372036854775808 -1)
; expect: 0
; line: (div -9223372036854775808 -1)
; expect: [MUSTER1] Function div expected a result within 64 bits
; expect: 1
; expect: refused
; line: (div 1 0)
; expect: [MUSTER1] Function div expected no division by zero
; expect: 1
; expect: refused
; line: (mod 1 0)
; expect: [MUSTER1] Function mod expected no division by zero
; expect: 0
; expect: refused
;
; line: (assert (pair a 1)) (assert (pair b 2)) (assert (pair a 1 x))
; expect: <Fact-9>
; expect: <Fact-10>
; expect: <Fact-11>
; line: (findall (pair ? $?))
; expect: (<Fact-9> <Fact-10> <Fact-11>)
; line: (findall (pair ? ?)) (findall (pair a $?)) (findall (pair $? x)) (findall (pair $? 2 $?))
; expect: (<Fact-9> <Fact-10>)
; expect: (<Fact-9> <Fact-11>)
; expect: (<Fact-11>)
; expect: (<Fact-10>)
; line: (findall (nothing-like-it ?)) (findall (pair))
; expect: ()
; expect: ()
; line: (bind ?n 2) (findall (pair b ?n)) (findall (pair b (+ 1 1)))
; expect: 2
; expect: (<Fact-10>)
; expect: (<Fact-10>)
; line: (fact-fields 11) (fact-fields (nth$ 1 (findall (pair b ?))))
; expect: (a 1 x)
; expect: (b 2)
; line: (fact-fields 99)
; expect: [MUSTER1] Function fact-fields expected an ordered fact that is there
; expect: ()
; expect: refused
; line: (findall pair)
; expect: [MUSTER4] Function findall expected a pattern in parentheses
; expect: refused
; line: (findall (pair ?) (pair ?))
; expect: [MUSTER4] Function findall expected one pattern
; expect: refused
;
; Without a map there is no way.
; line: (plan 100 200)
; expect: FALSE
; line: (plan 100)
; expect: [ARGACCES4] Function plan expected exactly 2 argument(s)
; expect: refused
