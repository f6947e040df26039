"""For measures_test.sh: change from frame to frame against closed forms. This file builds cameras and
intersects them with planes; the irradiance is known at every point of space."""
import numpy as np

from diptych import flicker

WIDTH, HEIGHT = 40, 24
PIXELS = WIDTH * HEIGHT
COLUMN, ROW = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))


def near(value, expected, tolerance):
    assert abs(value - expected) <= tolerance, (value, expected)


def points_at(x, y, z, depth, normal):
    points = np.zeros((HEIGHT, WIDTH), flicker.POINT)
    points["position"] = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
    points["depth"] = depth
    points["normal"] = points["plane"] = normal
    return points


def look_straight(right, up, of):
    """Pixels are unit squares of the plane z = 0; the frame looks at the plane further to the right and
    further up. Shows `of`, a function of x and y."""
    matrix = np.zeros((4, 4), np.float32)  # by columns
    matrix[0, 0], matrix[1, 1] = 2 / WIDTH, 2 / HEIGHT
    matrix[3] = -2 * right / WIDTH - 1, -2 * up / HEIGHT - 1, 0, 1
    x, y = COLUMN + 0.5 + right, HEIGHT - ROW - 0.5 + up
    points = points_at(x, y, 0, 10, (0, 0, 1))
    picture = of(x, y)[..., None] * np.array([1, 2, 3])
    return flicker.Frame(points, matrix, [picture.astype(np.float32)])


def cell(x, y):
    """A repeatable number in 0..1 for each cell of space."""
    seed = np.floor(x).astype(np.int64) * 2654435761 ^ np.floor(y).astype(np.int64) * 40503
    seed = (seed ^ seed >> 15) * 2246822519 & 0xffffffff
    return (seed >> 8) / 16777216


def slope(x, y):
    return 3 + 0.5 * x + 0.25 * y


def test_what_stands_still_does_not_change():
    frame = look_straight(0, 0, cell)
    change = flicker.change_of(frame, frame, 1)
    assert change.surfaces == change.compared == PIXELS and change.changes == [0]
    near(change.means[0], frame.pictures[0].mean(dtype=float), 1e-6)


def test_brightening_is_its_factor():
    before, now = look_straight(0, 0, cell), look_straight(0, 0, cell)
    now.pictures[0] = now.pictures[0] * np.float32(1.25)
    change = flicker.change_of(before, now, 1)
    near(change.changes[0], 0.25 * before.pictures[0].mean(dtype=float), 1e-6)
    near(change.changes[0] / change.means[0], 0.2, 1e-6)
    near(flicker.change_of(before, now, 8).changes[0], change.changes[0], 1e-6)  # all of one sign


def test_moved_textures_are_found_again():
    """A moved texture has no change: any texture moved by whole pixels, or a linear one moved by parts of
    pixels."""
    change = flicker.change_of(look_straight(0, 0, cell), look_straight(3, -2, cell), 1)
    assert change.compared == (WIDTH - 3) * (HEIGHT - 2)
    near(change.changes[0], 0, 1e-6)
    before, now = look_straight(0, 0, slope), look_straight(3.25, -1.5, slope)
    change = flicker.change_of(before, now, 1)
    assert change.compared == (WIDTH - 4) * (HEIGHT - 2)
    near(change.changes[0], 0, 1e-4)
    # at a fixed place of the picture, the change is the slope along the way
    now.points = before.points
    near(flicker.change_of(before, now, 1).changes[0], 2 * (3.25 * 0.5 - 1.5 * 0.25), 1e-4)


def test_what_comes_into_view_is_left_out():
    """Pixels without an earlier value are left out: where a plane nearer to the eye has gone, in columns
    10 to 14, and where a surface has turned. So is a pixel that is not finite."""
    before, now = look_straight(0, 0, slope), look_straight(0, 0, slope)
    before.points["position"][:, 10:15, 2] = 1
    before.pictures[0][:, 10:15] = 1000
    change = flicker.change_of(before, now, 1)
    assert change.surfaces == PIXELS and change.compared == PIXELS - 5 * HEIGHT
    assert change.changes == [0]
    before.points["normal"][0, 0] = 0.6, 0, 0.8
    now.points["depth"][0, -1] = 0
    now.pictures[0][-1, -1, 0] = np.nan
    change = flicker.change_of(before, now, 1)
    assert change.surfaces == PIXELS - 1 and change.compared == PIXELS - 5 * HEIGHT - 3
    assert change.changes == [0]


def look_down(eye, target, fov_y):
    """A floor y = 0 under a camera."""
    eye, target = np.array(eye), np.array(target)
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, (0, 1, 0))
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    half = np.tan(fov_y / 2)
    rows = np.zeros((4, 4))  # clip = rows @ (x, y, z, 1)
    for i, axis in enumerate((right * HEIGHT / WIDTH / half, up / half, None, ahead)):
        if axis is not None:
            rows[i, :3], rows[i, 3] = axis, -axis @ eye
    u = ((2 * (COLUMN + 0.5) / WIDTH - 1) * half * WIDTH / HEIGHT)[..., None]
    v = ((1 - 2 * (ROW + 0.5) / HEIGHT) * half)[..., None]
    ray = ahead + u * right + v * up
    depth = -eye[1] / ray[..., 1]
    place = eye + depth[..., None] * ray
    points = points_at(*np.moveaxis(place, -1, 0), depth, (0, 1, 0))
    picture = (3 + 0.5 * place[..., :1] - 0.25 * place[..., 2:]) * np.ones(3)
    return flicker.Frame(points, rows.T.astype(np.float32), [picture.astype(np.float32)])


def test_a_walking_camera_finds_the_floor_again():
    """It walks, turns and zooms."""
    before = look_down((0, 2, 3), (0, 0, 0), 0.7)
    now = look_down((0.2, 2.1, 2.9), (0.3, 0, 0.1), 0.75)
    change = flicker.change_of(before, now, 1)
    assert 0.6 * PIXELS <= change.compared < PIXELS
    # a linear function of the floor is not linear between pixels of a perspective
    near(change.changes[0], 0, 2e-3)
    assert np.abs(now.pictures[0] - before.pictures[0]).mean() > 0.05


def test_flicker_is_the_difference_of_changes():
    """Both pictures brighten by 0.5. The test adds 0.125 in every other column and subtracts 0.125 in the
    rest."""
    frames = []
    for t in range(2):
        frame = look_straight(0, 0, lambda x, y: 0 * x + 1)
        ripple = np.where(COLUMN % 2, -0.125, 0.125)[..., None] * np.ones(3)
        frame.pictures = [(2 + 0.5 * t + ripple * t).astype(np.float32),
                          np.full((HEIGHT, WIDTH, 3), 1 + 0.5 * t, np.float32)]
        frames.append(frame)
    change = flicker.change_of(*frames, 1)
    for got, right in zip((*change.changes, change.flicker, change.means[1]), (0.5, 0.5, 0.125, 1.5)):
        near(got, right, 1e-7)
    change = flicker.change_of(*frames, 2)
    near(change.flicker, 0, 1e-7)
    near(change.changes[0], 0.5, 1e-7)
    # 3 x 3 pixels have one column more of one sign, and a block of 1 column is left
    near(flicker.change_of(*frames, 3).flicker, (13 * 0.125 + 0.125) / WIDTH, 1e-6)


def test_means_are_weighted_by_pixels():
    whole = flicker.mean_of([flicker.Change(20, 10, [1.0], [2.0], 4.0),
                             flicker.Change(40, 30, [5.0], [6.0], 0.0)])
    assert whole == flicker.Change(60, 40, [4.0], [5.0], 1.0)
