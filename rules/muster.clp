; SPDX-License-Identifier: Apache-2.0
;
; The library that every robot loads before its own rule file.  A rule file changes it by defining a
; rule or a function of the same name.
;
; Goals: (goal safe-wander), (goal follow), (goal gohome ?x ?y), (goal stay), (goal wall ?side),
; (goal explore), (goal formation ?kind ?place); one at a time.
; Each behaviour acts once a step, calls (update-sensors), and tells where it is.

(deffunction new-goal ($?goal)
  "Replaces whatever the robot wants."
  (progn$ (?old (findall (goal $?)))
    (retract ?old))
  (assert (goal $?goal)))

(deffunction tell-position (?x ?y)
  "What followers wait for, in whole mm."
  (broadcast mate-pos ?*my-name* (round ?x) (round ?y)))

(extends "avoid.clp")
(extends "wander.clp")
(extends "follow.clp")
(extends "way.clp")
(extends "gohome.clp")
(extends "wall.clp")
(extends "explore.clp")
(extends "formation.clp")
(extends "timers.clp")
(extends "answers.clp")
