"""At night: the forecast of another loss."""

from report.live.test_live import check_forecast, desk, page_file


def test_the_forecast_of_a_loss_equals_a_run_with_it(desk, tmp_path):
    check_forecast(desk, tmp_path, "tunnel", 60.0)
