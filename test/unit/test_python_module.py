#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""The Python module: every solver and the robust estimator find a known motion; wrong arguments are named."""

import unittest

import numpy as np

import multicam_egomotion_solvers as mes

FOCAL = 400.0
CENTERS = np.array([[0.1, 0.5, 0.2], [0.0, -0.5, 0.1]])
R_BODY_CAM = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def rotation(vector):
    """Rotation matrix of a rotation vector [rad]."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


class Scene:
    """Points seen without noise by two cameras, in all camera pairs in turn."""

    def __init__(self, count, seed, rotation_vector=(0.03, -0.05, 0.15)):
        rng = np.random.default_rng(seed)
        self.rotation_vector = np.asarray(rotation_vector)
        self.R, self.t = rotation(self.rotation_vector), np.array([-0.8, 0.3, 0.05])
        self.cameras1, self.cameras2 = np.arange(count) % 2, (np.arange(count) + 1) // 2 % 2
        points = rng.uniform([6, -3, -2], [16, 3, 2], (count, 3))
        first, second = points - CENTERS[self.cameras1], points @ self.R.T + self.t - CENTERS[self.cameras2]
        self.rays1 = mes.rays_from_bearings(first, CENTERS[self.cameras1])
        self.rays2 = mes.rays_from_bearings(second, CENTERS[self.cameras2])
        self.pixels1, self.pixels2 = self._pixels(first), self._pixels(second)
        up = np.array([0.1, -0.2, 1.0])
        self.vertical = mes.VerticalPrior(up, self.R @ up)
        self.axis = mes.AxisPrior(self.rotation_vector)
        self.angle = mes.AnglePrior(np.linalg.norm(self.rotation_vector))

    @staticmethod
    def _pixels(directions):
        optical = directions @ R_BODY_CAM
        return FOCAL * optical[:, :2] / optical[:, 2:] + [320, 240]

    def prior(self, solver):
        if solver == "5pt-martyushev":
            return self.angle
        return self.axis if solver in ("4pt-axis", "4pt-sweeney") else self.vertical

    def sample(self):
        return self.rays1, self.rays2, self.cameras1, self.cameras2


def rig():
    poses = [np.block([[R_BODY_CAM, c[:, None]], [np.zeros(3), 1.0]]) for c in CENTERS]
    return mes.CameraRig([mes.Camera(640, 480, FOCAL, FOCAL, 320, 240, T) for T in poses])


class SolversTest(unittest.TestCase):
    def test_every_solver_finds_the_motion(self):
        for solver in mes.SOLVERS:
            for seed in range(20):
                # 4pt-liu is exact only for small angles.
                liu = solver == "4pt-liu"
                scene = Scene(int(solver[0]), seed, np.array([0.03, -0.05, 0.15]) * (1e-4 if liu else 1.0))
                found = mes.solve(solver, *scene.sample(), scene.prior(solver))
                with self.subTest(solver=solver, seed=seed):
                    self.assertEqual(found.status, "ok")
                    self.assertEqual(found.R.shape, (len(found), 3, 3))
                    self.assertEqual(found.t.shape, (len(found), 3))
                    errors = np.abs(found.R - scene.R).max(axis=(1, 2))
                    best = errors.argmin()
                    self.assertLess(errors[best], 1e-6)
                    self.assertTrue(found.scale_observable[best])
                    self.assertLess(np.abs(found.t[best] - scene.t).max(), 1e-3 if liu else 1e-5)

    def test_positive_depths_drop_solutions_but_not_the_true_one(self):
        dropped = 0
        for seed in range(20):
            scene = Scene(4, seed)
            every = mes.solve("4pt-vertical", *scene.sample(), scene.vertical)
            front = mes.solve("4pt-vertical", *scene.sample(), scene.vertical, positive_depths_only=True,
                              camera_centers=CENTERS)
            dropped += len(every) - len(front)
            self.assertLess(np.abs(front.R - scene.R).max(axis=(1, 2)).min(), 1e-9)
        self.assertGreater(dropped, 0)

    def test_the_length_of_a_ray_does_not_matter(self):
        scene = Scene(4, 2)
        unit = mes.solve("4pt-vertical", *scene.sample(), scene.vertical)
        scene.rays1 *= 3.0
        longer = mes.solve("4pt-vertical", *scene.sample(), scene.vertical)
        np.testing.assert_allclose(longer.t, unit.t, atol=1e-9)
        scene.rays1[1] = 0.0
        self.assertEqual(mes.solve("4pt-vertical", *scene.sample(), scene.vertical).status, "invalid_input")

    def test_one_camera_pair_is_central(self):
        scene = Scene(4, 1)
        rays1 = mes.rays_from_bearings(scene.rays1[:, :3], np.tile(CENTERS[0], (4, 1)))
        rays2 = mes.rays_from_bearings(scene.rays2[:, :3], np.tile(CENTERS[0], (4, 1)))
        found = mes.solve("4pt-vertical", rays1, rays2, 0, 0, scene.vertical)
        self.assertEqual((found.status, len(found)), ("central", 0))


class EstimatorTest(unittest.TestCase):
    def check(self, found, scene, outliers):
        self.assertTrue(found.success)
        self.assertLess(np.abs(found.R - scene.R).max(), 1e-6)
        self.assertLess(np.abs(found.t - scene.t).max(), 1e-4)
        self.assertEqual(found.inliers.dtype, bool)
        self.assertEqual(found.inlier_count, found.inliers.sum())
        self.assertGreater(found.inliers[~outliers].mean(), 0.99)
        self.assertLess(found.inliers[outliers].mean(), 0.2)
        self.assertEqual(found.covariance.shape, (6, 6))
        self.assertEqual(found.scale_state, "observable")

    def test_from_rays_and_from_pixels(self):
        scene = Scene(240, 5)
        outliers = np.arange(240) % 4 == 0
        pixels2, rays2 = scene.pixels2.copy(), scene.rays2.copy()
        pixels2[outliers] = np.random.default_rng(2).uniform([0, 0], [640, 480], (outliers.sum(), 2))
        rays2[outliers] = mes.rays_from_pixels(rig(), scene.cameras2[outliers], pixels2[outliers])
        for solver in ("4pt-vertical", "4pt-axis", "5pt-martyushev"):
            with self.subTest(solver=solver):
                prior = scene.prior(solver)
                self.check(mes.estimate(solver, scene.rays1, rays2, scene.cameras1, scene.cameras2, CENTERS, prior,
                                        pixels_per_radian=FOCAL), scene, outliers)
                self.check(mes.estimate_from_pixels(solver, rig(), scene.cameras1, scene.pixels1, scene.cameras2,
                                                    pixels2, prior), scene, outliers)

    def test_rays_from_pixels_are_those_from_bearings(self):
        scene = Scene(50, 3)
        np.testing.assert_allclose(mes.rays_from_pixels(rig(), scene.cameras1, scene.pixels1), scene.rays1, atol=1e-12)
        np.testing.assert_allclose(rig().centers, CENTERS)

    def test_pixels_without_a_ray_are_no_inliers(self):
        scene = Scene(60, 4)
        scene.pixels1[7] = np.nan
        found = mes.estimate_from_pixels("4pt-vertical", rig(), scene.cameras1, scene.pixels1, scene.cameras2,
                                         scene.pixels2, scene.vertical)
        self.assertFalse(found.inliers[7])
        self.assertEqual(found.inlier_count, 59)
        rays1 = mes.rays_from_pixels(rig(), scene.cameras1, scene.pixels1)
        self.assertTrue(np.isnan(rays1[7]).all())
        found = mes.estimate("4pt-vertical", rays1, scene.rays2, scene.cameras1, scene.cameras2, CENTERS,
                             scene.vertical, pixels_per_radian=FOCAL)
        self.assertFalse(found.inliers[7])
        self.assertEqual(found.inlier_count, 59)

    def test_options_and_priors(self):
        scene = Scene(100, 6)
        options = mes.Options(min_samples=7, max_samples=7, sampling=mes.Sampling.PROSAC)
        arguments = ("4pt-vertical", rig(), scene.cameras1, scene.pixels1, scene.cameras2, scene.pixels2, scene.vertical)
        found = mes.estimate_from_pixels(*arguments, options=options, quality=np.arange(100))
        self.assertEqual(found.samples, 7)
        again = mes.estimate_from_pixels(*arguments, options=options, quality=np.arange(100))
        np.testing.assert_array_equal(found.t, again.t)
        known = mes.MotionPriors(R=scene.R, R_sigma=1e-5)
        told = mes.estimate_from_pixels(*arguments, priors=known)
        self.assertLess(told.covariance[5, 5], found.covariance[5, 5] + 1e-9)
        self.assertLessEqual(told.covariance[5, 5], 1.01e-10)
        wrong = mes.MotionPriors(R=rotation([0, 0, 1.0]), R_sigma=1e-3)
        self.assertFalse(mes.estimate_from_pixels(*arguments, priors=wrong).success)


class ErrorsTest(unittest.TestCase):
    def refused(self, error, text, function, *arguments, **keywords):
        with self.assertRaises(error) as context:
            function(*arguments, **keywords)
        self.assertEqual(str(context.exception), text)

    def test_shapes_and_types(self):
        scene = Scene(4, 1)
        good = ["4pt-vertical", *scene.sample(), scene.vertical]

        def replaced(index, value):
            return good[:index] + [value] + good[index + 1:]

        self.refused(ValueError, "rays1: found shape (3, 6), expected an array of numbers of shape (4, 6)", mes.solve,
                     *replaced(1, scene.rays1[:3]))
        self.refused(ValueError, "rays2: found shape (4, 3), expected an array of numbers of shape (4, 6)", mes.solve,
                     *replaced(2, scene.rays2[:, :3]))
        self.refused(TypeError, "rays1: found str, expected an array of numbers of shape (4, 6)", mes.solve,
                     *replaced(1, "rays"))
        self.refused(ValueError, "cameras1: found shape (3,), expected a number or an array of shape (4,)", mes.solve,
                     *replaced(3, [0, 1, 0]))
        self.refused(TypeError, "prior of 4pt-vertical: found AxisPrior, expected VerticalPrior", mes.solve,
                     *replaced(5, scene.axis))
        self.refused(ValueError, "solver: found '4pt', expected one of " + ", ".join(mes.SOLVERS), mes.solve,
                     *replaced(0, "4pt"))

    def test_values(self):
        scene = Scene(20, 1)
        self.refused(ValueError, "cameras2: found camera 2.0, expected an index from 0 to 1", mes.estimate,
                     "4pt-vertical", scene.rays1, scene.rays2, 0, 2, CENTERS, scene.vertical, pixels_per_radian=FOCAL)
        self.refused(ValueError, "R, R_sigma: found only some of them, expected all or none", mes.MotionPriors,
                     R=np.eye(3))
        self.refused(TypeError, "Options: found 'max_sample', expected one of its attributes", mes.Options,
                     max_sample=3)
        with self.assertRaisesRegex(ValueError, "^T_body_cam is not a rigid motion: "):
            mes.Camera(640, 480, 400, 400, 320, 240, 2 * np.eye(4))
        with self.assertRaisesRegex(ValueError, "fx is -1, expected a positive focal length"):
            mes.Camera(640, 480, -1, 400, 320, 240, np.eye(4))


if __name__ == "__main__":
    unittest.main()
