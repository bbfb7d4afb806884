; SPDX-License-Identifier: Apache-2.0
;
; (follow NAME): goes where that robot says it is, and stays ?*follow-distance* mm behind it.
; The two rules bear the names of the paper's, so that a rule file with those replaces them.

(defglobal
  ?*mate-far* = 0       ; mm to the mate, when it last spoke
  ?*mate-aside* = 180   ; deg from straight ahead to it
  ?*trail* = (create$))  ; x y x y ...: where it went, from the place to go to next

(deffunction follow (?name)
  "Forgets what others said before: a global in a pattern is looked at only when mail comes."
  (progn$ (?old (findall (message mate-pos $?)))
    (retract ?old))
  (bind ?*mate* ?name)
  (bind ?*mate-aside* 180)
  (bind ?*trail* (create$))
  (new-goal follow))

(deffunction add-to-trail (?mate-x ?mate-y)
  "Notes where the mate is, every 300 mm, 60 places at most."
  (bind ?length (length$ ?*trail*))
  (if (or (= ?length 0)
          (> (distance (nth$ (- ?length 1) ?*trail*) (nth$ ?length ?*trail*) ?mate-x ?mate-y) 300))
   then
    (bind ?*trail* (create$ ?*trail* ?mate-x ?mate-y)))
  (if (> (length$ ?*trail*) 120) then
    (bind ?*trail* (delete$ ?*trail* 1 2))))

(deffunction mate-in-sight (?ring)
  "Nothing stands between: what the sonar sees there is the mate."
  (bind ?i 0)
  (bind ?least 25)
  (loop-for-count (?k 2 7) do
    (bind ?off (abs (- (nth$ ?k ?*ring*) ?*mate-aside*)))
    (if (< ?off ?least) then
      (bind ?least ?off)
      (bind ?i ?k)))
  (and (> ?i 0) (> (nth$ ?i ?ring) (- ?*mate-far* 800))))

(deffunction use-trail (?x ?y ?ring)
  "Drops the places that the robot has come by, and all but the last while it sees the mate."
  (bind ?length (length$ ?*trail*))
  (bind ?drop (if (mate-in-sight ?ring) then (- ?length 2) else 0))
  (loop-for-count (?k 1 (div ?length 2)) do
    (if (< (distance ?x ?y (nth$ (- (* 2 ?k) 1) ?*trail*) (nth$ (* 2 ?k) ?*trail*)) 500) then
      (bind ?drop (max ?drop (* 2 ?k)))))
  (if (> ?drop 0) then
    (bind ?*trail* (delete$ ?*trail* 1 ?drop))))

(deffunction aside (?x ?y ?compass ?to-x ?to-y)
  (norm-angle (- (bearing ?x ?y ?to-x ?to-y) ?compass)))

(deffunction way-to-mate (?x ?y ?compass)
  "Straight to a mate that is near, else the way that it went."
  (if (or (< ?*mate-far* 1500) (= 0 (length$ ?*trail*)))
   then ?*mate-aside*
   else (aside ?x ?y ?compass (nth$ 1 ?*trail*) (nth$ 2 ?*trail*))))

(deffunction follow-speed ()
  "mm/s: the faster the farther, none at ?*follow-distance*."
  (clamp (* 0.9 (- ?*mate-far* ?*follow-distance*)) 0 450))

(deffunction is-mate (?angle ?range)
  "Whether what this sonar sees is likely the mate and no obstacle."
  (and (<= (abs (- ?angle ?*mate-aside*)) 30)
       (> ?range (- ?*mate-far* 800))
       (> ?*mate-far* 550)))

(deffunction without-mate (?ring)
  "The front eight ranges, with the mate taken out."
  (bind ?clear (create$))
  (loop-for-count (?i 1 8) do
    (bind ?range (nth$ ?i ?ring))
    (bind ?clear (create$ ?clear (if (is-mate (nth$ ?i ?*ring*) ?range) then 3000 else ?range))))
  ?clear)

(deffunction room-left (?clear)
  "What stands far to the side is passed by: it counts half."
  (sonar-data (* 2 (nth$ 2 ?clear)) (nth$ 3 ?clear) (nth$ 4 ?clear)))

(deffunction room-right (?clear)
  (sonar-data (nth$ 5 ?clear) (nth$ 6 ?clear) (* 2 (nth$ 7 ?clear))))

(deffunction too-near (?ring)
  (bind ?clear (without-mate ?ring))
  (or (< (room-left ?clear) 150)
      (< (room-right ?clear) 150)))

; Obstacle avoidance while following the mate.
(defrule safe-following
  (declare (salience 10))
  (goal follow)
  (position ? ?x ?y $?)
  (sonar ? $?ring&:(>= (length$ ?ring) 8))
  (test (too-near ?ring))
  =>
  (bind ?clear (without-mate ?ring))
  (bind ?minL (room-right ?clear))
  (bind ?minR (room-left ?clear))
  (if (and (= ?minL 0) (= ?minR 0))
   then (setSpeed 0 60)
   else (setSpeed (* 0.3 (+ ?minL ?minR)) (* 0.14 (- ?minR ?minL))))
  (update-sensors)
  (tell-position ?x ?y))

; Go to the mate.
(defrule follow-robot
  (declare (salience 2))
  (goal follow)
  (message mate-pos ?*mate* ?mate-x ?mate-y)
  (sonar ? $?ring&:(>= (length$ ?ring) 8))
  (position ?time ?x ?y ? ? ?compass ?)
  =>
  (bind ?*mate-far* (distance ?x ?y ?mate-x ?mate-y))
  (bind ?*mate-aside* (aside ?x ?y ?compass ?mate-x ?mate-y))
  (add-to-trail ?mate-x ?mate-y)
  (use-trail ?x ?y ?ring)
  (bind ?speed (follow-speed))
  (if (= ?speed 0)
   then
    (standing ?time ?x ?y)
    (setSpeed 0 (clamp ?*mate-aside* -40 40))
   else
    (bind ?way (detour ?time ?x ?y ?compass (way-to-mate ?x ?y ?compass)))
    (if (> (abs ?way) 80)
     then (setSpeed 0 (if (> ?way 0) then 70 else -70))
     else (steer ?speed ?way (only-before ?*mate-far* (without-mate ?ring)))))
  (update-sensors)
  (tell-position ?x ?y))

; The mate has not said anything yet, or not for a long time.
(defrule wait-for-mate
  (declare (salience -10))
  (goal follow)
  (position ? ?x ?y $?)
  =>
  (stop)
  (update-sensors)
  (tell-position ?x ?y))
