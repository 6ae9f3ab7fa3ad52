"""Rasters say what the map says, where it says it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
import xarray

from subsoil.errors import MissingExtraError
from subsoil.io.write.rasters import write_geotiffs
from subsoil.land.field import Field
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import standard_deviation
from subsoil.variogram import Spherical

LAYERS = Layers((0.0, 0.1, 0.15, 0.2))
CORNERS = np.array([(3.0, 4.0), (60.0, 0.0), (57.0, 41.0), (2.0, 38.0)])


def land(crs: str = "EPSG:32630") -> Field:
    origin = (681_000.0, 5_900_000.0) if crs else (0.0, 0.0)
    hole = np.array([(20, 15), (31, 15), (31, 26), (20, 26)]) + origin
    return Field.from_metres(CORNERS + origin, crs=crs, keep_outs=[hole], name="land")


def mapped(field: Field) -> SoilMap:
    """Map of six samples, none of which reached the deepest layer."""
    rng = np.random.default_rng(4)
    state = np.array([0, 0, 2], dtype=np.int8)
    samples = tuple(
        Sample(tuple(at), np.array([*rng.uniform(300, 1500, 2), np.nan]), state)
        for at in field.cells[::14][:6].tolist()
    )
    return SoilMap(field, LAYERS, (Spherical(400.0, 30.0, 9_000.0),) * 3, samples)


def bands_at(path: Path, at: np.ndarray) -> np.ndarray:
    with rasterio.open(path) as raster:
        return np.array(list(raster.sample(at))).T


@pytest.mark.parametrize("crs", ["EPSG:32630", ""])
def test_a_geotiff_gives_the_maps_value_at_every_cell_centre(tmp_path: Path, crs: str) -> None:
    field = land(crs)
    soil_map = mapped(field)
    mean, std_dev = write_geotiffs(soil_map, tmp_path)
    assert (mean.name, std_dev.name) == ("mean_kpa.tif", "std_dev_kpa.tif")
    at = field.cells
    np.testing.assert_allclose(bands_at(mean, at), soil_map.mean, rtol=1e-6)
    expected = np.sqrt(soil_map.variance)
    np.testing.assert_allclose(bands_at(std_dev, at), expected, rtol=1e-6)
    assert np.isnan(soil_map.mean[2]).all()


def test_a_geotiff_is_empty_outside_the_field_and_in_keep_outs(tmp_path: Path) -> None:
    field = land()
    path, _ = write_geotiffs(mapped(field), tmp_path)
    with rasterio.open(path) as raster:
        known = np.isfinite(raster.read(1))
    assert np.array_equal(known[::-1], field.grid.inside)
    assert not known.all()


def test_a_geotiff_lies_north_up_on_the_edges_of_the_cells(tmp_path: Path) -> None:
    field = land()
    path, _ = write_geotiffs(mapped(field), tmp_path)
    with rasterio.open(path) as raster:
        assert tuple(raster.bounds) == (681_000.0, 5_900_000.0, 681_060.0, 5_900_045.0)
        assert raster.res == (5.0, 5.0)
        assert raster.transform.e < 0
        assert raster.crs.to_epsg() == 32630


def test_bands_are_named_after_layers_and_carry_their_unit(tmp_path: Path) -> None:
    field = land()
    for path in write_geotiffs(mapped(field), tmp_path):
        with rasterio.open(path) as raster:
            assert raster.descriptions == ("0.00-0.10 m", "0.10-0.15 m", "0.15-0.20 m")
            assert raster.units == ("kPa",) * 3
            assert raster.dtypes == ("float32",) * 3
            assert np.isnan(raster.nodata)


def test_a_geotiff_is_cloud_optimised_and_compressed(tmp_path: Path) -> None:
    field = land()
    path, _ = write_geotiffs(mapped(field), tmp_path)
    with rasterio.open(path) as raster:
        structure = raster.tags(ns="IMAGE_STRUCTURE")
        assert raster.profile["tiled"]
    assert structure["LAYOUT"] == "COG"
    assert (structure["COMPRESSION"], structure["PREDICTOR"]) == ("DEFLATE", "3")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mean_kpa.tif", "std_dev_kpa.tif"]


def test_a_geotiff_of_a_local_frame_names_no_crs(tmp_path: Path) -> None:
    field = land("")
    path, _ = write_geotiffs(mapped(field), tmp_path)
    with rasterio.open(path) as raster:
        assert raster.crs is None
        assert tuple(raster.bounds) == (0.0, 0.0, 60.0, 45.0)


def test_a_dataset_gives_the_maps_value_at_every_cell_centre() -> None:
    field = land()
    soil_map = mapped(field)
    data = soil_map.to_xarray()
    east, north = (xarray.DataArray(c, dims="cell") for c in field.cells.T)
    here = data.sel(easting=east, northing=north)
    np.testing.assert_array_equal(here["mean"].values, soil_map.mean)
    np.testing.assert_array_equal(here["variance"].values, soil_map.variance)
    np.testing.assert_allclose(here["std_dev"].values ** 2, soil_map.variance, rtol=1e-14)
    assert data["mean"].dims == ("depth", "northing", "easting")


def test_a_dataset_says_its_units_depths_and_frame() -> None:
    data = mapped(land()).to_xarray()
    assert {name: data[name].attrs["units"] for name in data} == {
        "mean": "kPa",
        "std_dev": "kPa",
        "variance": "kPa2",
    }
    layer = data.sel(depth=0.175)
    assert layer["layer"] == "0.15-0.20 m"
    depths = [float(layer[name]) for name in ("depth_top", "depth", "depth_bottom")]
    assert depths == pytest.approx([0.15, 0.175, 0.20])
    assert data["depth"].attrs["positive"] == "down"
    assert data["mean"].attrs["grid_mapping"] == "crs"
    assert "UTM zone 30N" in data["crs"].attrs["crs_wkt"]


def test_a_dataset_of_a_local_frame_has_no_crs() -> None:
    data = mapped(land("")).to_xarray()
    assert "crs" not in data.coords
    assert "grid_mapping" not in data["mean"].attrs


def test_a_dataset_survives_a_netcdf_file(tmp_path: Path) -> None:
    data = mapped(land()).to_xarray()
    data.to_netcdf(tmp_path / "map.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "map.nc", engine="scipy") as back:
        xarray.testing.assert_allclose(back.load(), data)


def test_a_map_without_samples_is_nan_everywhere(tmp_path: Path) -> None:
    field = land()
    empty = SoilMap(field, LAYERS)
    path, _ = write_geotiffs(empty, tmp_path)
    assert np.isnan(bands_at(path, field.cells)).all()
    assert empty.to_xarray()["mean"].isnull().all()


def test_a_negative_variance_is_not_made_into_a_number() -> None:
    root = standard_deviation([4.0, 0.0, -1e-30, np.nan])
    np.testing.assert_array_equal(root, [2.0, 0.0, np.nan, np.nan])


def test_a_missing_library_is_named_with_its_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    field = land()
    for name in ("rasterio", "xarray"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingExtraError, match=r"rasterio.*subsoil\[geo\]"):
        write_geotiffs(mapped(field), tmp_path)
    with pytest.raises(MissingExtraError, match=r"xarray.*subsoil\[geo\]"):
        mapped(field).to_xarray()
