; SPDX-License-Identifier: Apache-2.0
;
; Steering round obstacles with the front half of the sonar ring, and getting free again.
; Angles are relative to the robot, in degrees, left is positive; ranges are in mm.

(defglobal
  ?*ring* = (create$ 90 50 30 10 -10 -30 -50 -90)  ; where s0..s7 look
  ?*steer-free* = 1100    ; a range that needs no care
  ?*steer-stop* = 330     ; so close ahead: turn on the spot
  ?*steer-turn* = 70      ; deg/s at most
  ?*steer-last* = 0       ; the direction chosen in the last step
  ?*mark-time* = 0.0      ; s: where the robot was then
  ?*mark-x* = 0.0
  ?*mark-y* = 0.0
  ?*detour-until* = -1.0  ; s
  ?*detour-way* = 0.0     ; deg, a compass direction
  ?*escape-until* = -1.0  ; s
  ?*escape-side* = 1)     ; 1 left, -1 right

(deffunction range-towards (?i ?ring)
  "The range of sonar i, no better than its neighbours allow."
  (bind ?left (if (> ?i 1) then (+ 200 (nth$ (- ?i 1) ?ring)) else 5000))
  (bind ?right (if (< ?i 8) then (+ 200 (nth$ (+ ?i 1) ?ring)) else 5000))
  (min (nth$ ?i ?ring) ?left ?right))

(deffunction ahead (?ring)
  "The free way ahead: what stands aside counts less, as far as the body passes by it."
  (min (nth$ 4 ?ring) (nth$ 5 ?ring)
       (* 2 (nth$ 3 ?ring)) (* 2 (nth$ 6 ?ring))
       (* 3.5 (nth$ 2 ?ring)) (* 3.5 (nth$ 7 ?ring))))

(deffunction push-aside (?ring)
  "Degrees to lean away from what is close at one side."
  (bind ?left (max 0 (- 380 (min (nth$ 1 ?ring) (nth$ 2 ?ring) (nth$ 3 ?ring)))))
  (bind ?right (max 0 (- 380 (min (nth$ 6 ?ring) (nth$ 7 ?ring) (nth$ 8 ?ring)))))
  (* 0.15 (- ?right ?left)))

(deffunction free-direction (?want ?ring)
  "The direction nearest to the wanted one that is free; keeps to a side once chosen."
  (bind ?best 0)
  (bind ?least 1000000)
  (loop-for-count (?i 1 8) do
    (bind ?angle (nth$ ?i ?*ring*))
    (bind ?near (max 0 (- ?*steer-free* (range-towards ?i ?ring))))
    (bind ?cost (+ (abs (- ?angle ?want)) (* 0.15 ?near) (* 0.35 (abs (- ?angle ?*steer-last*)))))
    (if (< ?cost ?least) then
      (bind ?least ?cost)
      (bind ?best ?angle)))
  (if (<= (abs (- ?best ?want)) 25) then ?want else ?best))

(deffunction steer (?speed ?want ?ring)
  "Drives at most this fast in the wanted direction, round what is in the way."
  (bind ?direction (free-direction (clamp ?want -90 90) ?ring))
  (bind ?*steer-last* ?direction)
  (bind ?direction (+ ?direction (push-aside ?ring)))
  (bind ?room (clamp (/ (- (ahead ?ring) ?*steer-stop*) 700.0) 0 1))
  (bind ?turn (clamp (* 1.5 ?direction) (- 0 ?*steer-turn*) ?*steer-turn*))
  (if (and (= ?room 0) (< (abs ?turn) 30)) then
    (bind ?turn (if (< ?turn 0) then -40 else 40)))
  (bind ?facing (max 0 (cosd ?direction)))
  (setSpeed (* ?speed ?room ?facing) ?turn))

(deffunction only-before (?far ?ring)
  "The front eight ranges; what stands behind the place to go to is not in the way."
  (bind ?clear (create$))
  (loop-for-count (?i 1 8) do
    (bind ?range (nth$ ?i ?ring))
    (bind ?clear (create$ ?clear (if (> ?range ?far) then 5000 else ?range))))
  ?clear)

(deffunction standing (?time ?x ?y)
  "Standing still is wanted: no reason for a detour."
  (bind ?*mark-time* ?time)
  (bind ?*mark-x* ?x)
  (bind ?*mark-y* ?y))

(deffunction detour (?time ?x ?y ?compass ?aside)
  "The direction to take: the wanted one, or for a while another if there was no way on."
  (if (> (- ?time ?*mark-time*) 5) then
    (if (< (distance ?x ?y ?*mark-x* ?*mark-y*) 200) then
      (bind ?*detour-until* (+ ?time (* 0.1 (random 30 70))))
      (bind ?*detour-way* (+ ?compass ?aside (* (random 60 140) (- (* 2 (random 0 1)) 1)))))
    (standing ?time ?x ?y))
  (if (< ?time ?*detour-until*) then (norm-angle (- ?*detour-way* ?compass)) else ?aside))

(deffunction start-escape (?time ?ring)
  "Away from the side that is nearer; at each start a little different."
  (bind ?left (min (nth$ 1 ?ring) (nth$ 2 ?ring) (nth$ 3 ?ring)))
  (bind ?right (min (nth$ 6 ?ring) (nth$ 7 ?ring) (nth$ 8 ?ring)))
  (bind ?*escape-side* (if (> ?left ?right) then 1 else -1))
  (bind ?*escape-until* (+ ?time 1.2 (* 0.1 (random 0 8)))))

(deffunction escape (?time ?back)
  "Backs off while there is room behind, then turns."
  (if (and (> (- ?*escape-until* ?time) 0.7) (> ?back 150))
   then (setSpeed -160 (* 15 ?*escape-side*))
   else (setSpeed 0 (* 60 ?*escape-side*))))

; Held up: whatever the goal is, get free first.
(defrule escape
  (declare (salience 20))
  (goal ~stay $?)
  (position ?time ?x ?y ? ? ? ?stalled)
  (sonar ? $?ring&:(>= (length$ ?ring) 8))
  (test (or (eq ?stalled TRUE) (< ?time ?*escape-until*)))
  =>
  (if (>= ?time ?*escape-until*) then
    (start-escape ?time ?ring))
  (escape ?time (if (>= (length$ ?ring) 14) then (min (nth$ 12 ?ring) (nth$ 13 ?ring)) else 0))
  (update-sensors)
  (tell-position ?x ?y))
