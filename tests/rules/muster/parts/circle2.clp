; SPDX-License-Identifier: Apache-2.0
(extends "circle.clp")
