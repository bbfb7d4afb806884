; SPDX-License-Identifier: Apache-2.0
;
; Looks for pucks of one colour with the camera, takes one with the gripper, carries it home by GPS and
; lets it go there.  Lengths in mm, angles in degrees.

(defglobal
  ?*color* = red
  ?*pucks* = 4            ; so many there are; when they are home it waits at
  ?*wait-x* = 0
  ?*wait-y* = 0
  ?*brought* = 0
  ?*asked* = -10          ; s: when the gripper was told to go up or down
  ?*home-x* = -4500
  ?*home-y* = -3500
  ?*home-wide* = 1400     ; pucks so near to home are left alone
  ?*row-x* = -5300        ; where the first one is put,
  ?*row-y* = -3500
  ?*row-step-x* = 400     ; and how far from it the next
  ?*row-step-y* = 0
  ?*drop-near* = 350      ; so near it lets go
  ?*lift-near* = 1000     ; nearer it keeps the paddles up, and moves nothing with them
  ?*eye-ahead* = 100      ; of the camera, before the robot's middle
  ?*aim-range* = 700)     ; nearer than this it aims, and looks out for nothing else

; (task search), (task grip SINCE), (task carry), (task release SINCE), (task aside UNTIL), (task back UNTIL)
(deffacts beginning
  (goal collect)
  (task search))

(deffunction new-task ($?task)
  (progn$ (?old (findall (task $?)))
    (retract ?old))
  (assert (task $?task)))

(deffunction collect ()
  (new-goal collect)
  (new-task search))

(deffunction gripper-says (?field)
  "1 open or closed, 2 up or down, 3 outer, 4 inner, 5 holds."
  (bind ?state (gripper))
  (if (eq ?state (create$)) then FALSE else (nth$ ?field ?state)))

(deffunction is-home (?x ?y ?compass ?bearing ?range)
  "Whether a puck that is seen there is at home."
  (bind ?way (+ ?compass ?bearing))
  (bind ?px (+ ?x (* ?*eye-ahead* (cosd ?compass)) (* ?range (cosd ?way))))
  (bind ?py (+ ?y (* ?*eye-ahead* (sind ?compass)) (* ?range (sind ?way))))
  (< (distance ?px ?py ?*home-x* ?*home-y*) ?*home-wide*))

(deffunction wanted-puck (?x ?y ?compass)
  "Bearing and range of the nearest puck that is not at home, or ()."
  (bind ?blobs (camera ?*color*))
  (while (> (length$ ?blobs) 0)
    (bind ?bearing (nth$ 2 ?blobs))
    (bind ?range (nth$ 4 ?blobs))
    (if (not (is-home ?x ?y ?compass ?bearing ?range)) then
      (return (create$ ?bearing ?range)))
    (bind ?blobs (rest$ (rest$ (rest$ (rest$ ?blobs))))))
  (create$))

(deffunction roam (?time ?x ?y ?compass ?turn-rate)
  (if (>= ?time ?*wander-until*) then
    (change-mind ?time))
  (bind ?want ?*wander-want*)
  (if (< (nth$ 2 (clear-way 0)) ?*wander-sight*) then
    (bind ?want (* ?*wander-turn* (better-side ?turn-rate))))
  (steer ?*wander-speed* (detour ?time ?x ?y ?compass ?want) 5000))

(deffunction wait-aside (?time ?x ?y ?compass)
  "Goes where it is in nobody's way."
  (bind ?far (distance ?x ?y ?*wait-x* ?*wait-y*))
  (bind ?aside (aside ?x ?y ?compass ?*wait-x* ?*wait-y*))
  (if (< ?far 200)
   then (standing ?time ?x ?y)
        (setSpeed 0 20) ; and looks around
   else (steer 300 (detour ?time ?x ?y ?compass ?aside) ?far)))

(deffunction look-out (?time ?x ?y ?compass ?turn-rate)
  (if (< ?*brought* ?*pucks*)
   then (roam ?time ?x ?y ?compass ?turn-rate)
   else (wait-aside ?time ?x ?y ?compass)))

(deffunction is-between ()
  "Whether a puck of its colour is between the paddles: it breaks the inner beam."
  (bind ?blobs (camera ?*color*))
  (and (eq (gripper-says 2) down) (eq (gripper-says 4) TRUE)
       (> (length$ ?blobs) 0) (< (nth$ 4 ?blobs) 200)))

(deffunction aim (?bearing ?range)
  "Creeps up to what is between the paddles soon."
  (setSpeed (if (< (abs ?bearing) 10) then (clamp (/ ?range 3) 60 150) else 0)
            (clamp (* 2 ?bearing) -40 40)))

; At home the paddles are up, elsewhere down; it waits for them.
(defrule change-height
  (declare (salience 9))
  (goal collect)
  (task search)
  (position ?time ?x ?y $?)
  (test (neq (gripper-says 2)
             (if (< (distance ?x ?y ?*home-x* ?*home-y*) ?*lift-near*) then up else down)))
  =>
  (standing ?time ?x ?y)
  (stop)
  (if (> (- ?time ?*asked*) 5)
   then (bind ?*asked* ?time)
        (gripper (if (eq (gripper-says 2) up) then lower else lift))
   else (if (> (- ?time ?*asked*) 2.5) then ; something is below it
          (bind ?*asked* -10)
          (new-task back (+ ?time 1.5))))
  (update-sensors))

; What is between the paddles is taken.
(defrule take
  (declare (salience 8))
  (goal collect)
  (task search)
  (position ?time $?)
  (test (is-between))
  =>
  (stop)
  (gripper close)
  (new-task grip ?time)
  (update-sensors))

(defrule search
  (goal collect)
  (task search)
  (position ?time ?x ?y ? ?turn-rate ?compass ?)
  =>
  (bind ?puck (wanted-puck ?x ?y ?compass))
  (if (eq ?puck (create$)) then (look-out ?time ?x ?y ?compass ?turn-rate)
   else (bind ?bearing (nth$ 1 ?puck))
        (bind ?range (nth$ 2 ?puck))
        (standing ?time ?x ?y)
        (if (< ?range ?*aim-range*) then (aim ?bearing ?range)
         else (steer 300 ?bearing (- ?range 300))))
  (update-sensors))

(defrule hold
  (goal collect)
  (task grip ?since)
  (position ?time $?)
  =>
  (stop)
  (if (eq (gripper-says 5) TRUE) then (gripper lift) (new-task carry)
   else (if (> (- ?time ?since) 3) then (gripper open) (new-task back (+ ?time 2))))
  (update-sensors))

(defrule carry
  (goal collect)
  (task carry)
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (bind ?gps (gps))
  (bind ?row-x (+ ?*row-x* (* (mod ?*brought* ?*pucks*) ?*row-step-x*)))
  (bind ?row-y (+ ?*row-y* (* (mod ?*brought* ?*pucks*) ?*row-step-y*)))
  (bind ?far (distance (nth$ 1 ?gps) (nth$ 2 ?gps) ?row-x ?row-y))
  (bind ?aside (aside (nth$ 1 ?gps) (nth$ 2 ?gps) (nth$ 3 ?gps) ?row-x ?row-y))
  (if (< ?far ?*drop-near*)
   then (stop) (gripper lower) (new-task release ?time)
   else (steer 300 (detour ?time ?x ?y ?compass ?aside) ?far))
  (update-sensors))

; Lowered it is let go; when the paddles are open there is nothing more to do here.  A gripper that does
; not come down has something below it.
(defrule release
  (goal collect)
  (task release ?since)
  (position ?time $?)
  =>
  (stop)
  (if (eq (gripper-says 2) down) then (gripper open)
   else (if (> (- ?time ?since) 2) then (new-task aside (+ ?time 1.2))))
  (if (and (eq (gripper-says 1) open) (eq (gripper-says 5) FALSE)) then
    (bind ?*brought* (+ ?*brought* 1))
    (new-task back (+ ?time 3)))
  (update-sensors))

; There may be room a bit before.
(defrule step-aside
  (goal collect)
  (task aside ?until)
  (position ?time $?)
  =>
  (setSpeed -200 10)
  (if (> ?time ?until) then (stop) (gripper lower) (new-task release ?time))
  (update-sensors))

(defrule back-off
  (goal collect)
  (task back ?until)
  (position ?time ?x ?y $?)
  =>
  (setSpeed -200 0)
  (standing ?time ?x ?y)
  (if (> ?time ?until) then (new-task search))
  (update-sensors))
