; SPDX-License-Identifier: Apache-2.0
; options: library=no
; Groups, the yellow pages, and addresses that are no names.
; line: (group-create south) (group-join scouts) (group-leave north)
; expect: change group-create south ""
; expect: change group-join scouts ""
; expect: change group-leave north ""
; expect: TRUE
; expect: TRUE
; expect: TRUE
; line: (group-join nobody)
; expect: FALSE
; line: (group-create "not a name")
; expect: [MUSTER1] Function group-create expected a name for a group
; expect: FALSE
; expect: refused
; line: (group-join 3)
; expect: [ARGACCES5] Function group-join expected argument #1 to be of type symbol or string
; expect: refused
; line: (group-leave "")
; expect: [MUSTER1] Function group-leave expected the name of a group
; expect: FALSE
; expect: refused
; line: (group-leave)
; expect: [ARGACCES4] Function group-leave expected exactly 1 argument(s)
; expect: refused
; line: (groups) (members north) (members scouts) (members nowhere)
; expect: (north observer scouts)
; expect: (blue red)
; expect: (green)
; expect: ()
; line: (groups north)
; expect: [ARGACCES4] Function groups expected exactly 0 argument(s)
; expect: refused
; line: (members "a b")
; expect: [MUSTER1] Function members expected the name of a group
; expect: ()
; expect: refused
; line: (group-send north gold at 1 2.5)
; expect: mail group:north "gold at 1 2.5"
; expect: TRUE
; line: (group-send "a b" gold)
; expect: [MUSTER1] Function group-send expected the name of a group
; expect: FALSE
; expect: refused
; line: (group-send)
; expect: [ARGACCES4] Function group-send expected at least 1 argument(s)
; expect: refused
; line: (group-send north (/ 1e308 1e-10))
; expect: [MUSTER1] Function group-send expected fields that can be mailed: symbols, strings, finite numbers
; expect: FALSE
; expect: refused
;
; line: (advertise mapper) (advertise mapper role scout battery 0.8 x 3 y -1.5)
; expect: change advertise mapper ""
; expect: change advertise mapper "role=scout battery=0.8 x=3 y=-1.5"
; expect: TRUE
; expect: TRUE
; line: (withdraw mapper)
; expect: change withdraw mapper ""
; expect: TRUE
; line: (withdraw nobody)
; expect: FALSE
; line: (advertise mapper role)
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
; line: (advertise mapper role "a b")
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
; line: (advertise mapper x 1 x 2)
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
; line: (advertise mapper "x=1 y" 2)
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
; line: (advertise mapper x (create$ 1 2))
; expect: [MUSTER1] Function advertise expected pairs of key and value: each key a name, and once; values without blanks; 255 bytes in all
; expect: FALSE
; expect: refused
; line: (advertise "no name" x 1)
; expect: [MUSTER1] Function advertise expected a name for a service
; expect: FALSE
; expect: refused
; line: (withdraw 3)
; expect: [ARGACCES5] Function withdraw expected argument #1 to be of type symbol or string
; expect: refused
;
; line: (find-service mapper) (find-service mapper role=scout) (find-service nothing)
; expect: (green red)
; expect: (green)
; expect: ()
; line: (find-service mapper battery>=0.5) (find-service mapper battery<0.5) (find-service mapper battery<=0.4 role!=scout)
; expect: (green)
; expect: (red)
; expect: (red)
; line: (bind ?least 0.5) (find-service mapper battery>= ?least) (find-service "mapper role=digger")
; expect: 0.5
; expect: (green)
; expect: (red)
; line: (find-service mapper near=5,5.5,1) (find-service (create$ mapper role=scout)) (find-service *)
; expect: (red)
; expect: (green)
; expect: (green red)
; line: (find-service mapper role)
; expect: [MUSTER1] Function find-service expected a service, or *, and constraints such as role=scout battery>=0.5 near=X,Y,METRES
; expect: ()
; expect: refused
; line: (find-service)
; expect: [ARGACCES4] Function find-service expected at least 1 argument(s)
; expect: refused
;
; line: (send-role digger come 1) (send-task dig come) (send-near 2500 come "to me") (send-near 0.5 x)
; expect: mail role:digger "come 1"
; expect: mail task:dig "come"
; expect: mail near:2.5 "come "to me""
; expect: mail near:0.0005 "x"
; expect: TRUE
; expect: TRUE
; expect: TRUE
; expect: TRUE
; line: (send-role "a b" x)
; expect: [MUSTER1] Function send-role expected the name of a role
; expect: FALSE
; expect: refused
; line: (send-task 3 x)
; expect: [ARGACCES5] Function send-task expected argument #1 to be of type symbol or string
; expect: refused
; line: (send-near -1 x)
; expect: [MUSTER1] Function send-near expected a distance in mm, 0 or more
; expect: FALSE
; expect: refused
; line: (send-near far x)
; expect: [ARGACCES5] Function send-near expected argument #1 to be of type integer or float
; expect: refused
;
; Addresses, and several names, wherever a mail is for somebody.
; line: (send group:north hello) (tell (create$ red green) hello) (send near:2.5 hello)
; expect: mail group:north "hello"
; expect: mail red,green tell "hello"
; expect: mail near:2.5 "hello"
; expect: TRUE
; expect: TRUE
; expect: TRUE
; line: (send (create$ red "a b") hello)
; expect: [MUSTER1] Function send expected the name of an agent, or several
; expect: FALSE
; expect: refused
; line: (send ":x" hello)
; expect: [MUSTER1] Function send expected the name of an agent, or several
; expect: FALSE
; expect: refused
;
; A mail whose fields come from sending another one.
; line: (send red first (send green second))
; expect: mail green "second"
; expect: mail red "first TRUE"
; expect: TRUE
; line: (send (progn (tell (create$ blue green) inner) red) outer)
; expect: mail blue,green tell "inner"
; expect: mail red "outer"
; expect: TRUE
;
; you-do takes a group by its address, or by its name where no agent bears that.
; line: (you-do group:north follow blue) (you-do scouts wander) (you-do red wander) (you-do all stay)
; expect: do group:north "(follow blue)"
; expect: do group:scouts "(wander)"
; expect: do red "(wander)"
; expect: do all "(stay)"
; expect: TRUE
; expect: TRUE
; expect: TRUE
; expect: TRUE
; A name that is reserved is an agent's, whether that is there or not.
; line: (you-do observer wander) (you-do group:observer wander)
; expect: do observer "(wander)"
; expect: do group:observer "(wander)"
; expect: TRUE
; expect: TRUE
; line: (you-do (create$ red group:north) wander)
; expect: [MUSTER1] Function you-do expected a name, a group or a multifield of names, a command, its fields
; expect: FALSE
; expect: refused
; line: (you-do red 3)
; expect: [MUSTER1] Function you-do expected a name, a group or a multifield of names, a command, its fields
; expect: FALSE
; expect: refused
;
; line: (speak inform red x priority high level logged layer 4) (speak inform red x priority low level synced)
; expect: mail red inform layer=4 priority=1 level=logged "x"
; expect: mail red inform priority=-1 level=synced "x"
; expect: TRUE
; expect: TRUE
; line: (speak inform red x priority normal level ram) (speak inform (create$ red green) x)
; expect: mail red inform "x"
; expect: mail red,green inform "x"
; expect: TRUE
; expect: TRUE
; line: (speak inform red x priority urgent)
; expect: [MUSTER1] Function speak expected low, normal or high behind priority
; expect: FALSE
; expect: refused
; line: (speak inform red x level disk)
; expect: [MUSTER1] Function speak expected ram, logged or synced behind level
; expect: FALSE
; expect: refused
; line: (speak inform red x layer 0)
; expect: [MUSTER1] Function speak expected a layer: a whole number from 1 on
; expect: FALSE
; expect: refused
;
; What the broker refuses becomes a fact.
; line: (deffunction told () (progn$ (?f (findall (event $?))) (printout t (fact-fields ?f) crlf)))
; refused: group-create north group-exists
; line: (told)
; expect: (refused group-create north group-exists)
; refused: group-create north group-exists
; refused: withdraw mapper not-offered
; line: (told)
; expect: (refused group-create north group-exists)
; expect: (refused withdraw mapper not-offered)
