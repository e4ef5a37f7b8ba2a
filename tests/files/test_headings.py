"""Headings of tables in several languages: the columns are what they are under English ones."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from tests.helpers.serving import LIMITS

ENGLISH = "order,latitude,longitude,quantity,window start,window end,service [min],driver"
ROWS = """
depot,60.17,24.94,0,,,,
a,60.18,24.95,3,08:00,12:00,5,Mia
b,60.16,24.93,4,09:00,11:00,10,Tom
"""
OTHERS = {
    "German": "Bestellnummer,Breite,Länge,Menge,von,bis,Standzeit [min],Fahrer",
    "French": "Commande,Latitude,Longitude,Quantité,Heure début,Heure fin,Durée [min],Chauffeur",
    "Italian": "Ordine,Latitudine,Longitudine,Colli,Ora inizio,Ora fine,Durata [min],Autista",
    "Spanish": "Pedido,Latitud,Longitud,Bultos,Hora inicio,Hora fin,Duración [min],Conductor",
    "Portuguese": "Pedido,Latitude,Longitude,Volumes,Abertura,Fechamento,Duração [min],Motorista",
    "Dutch": "Bestelling,Breedtegraad,Lengtegraad,Paketten,Begintijd,Eindtijd,Duur [min],Chauffeur",
    "Finnish": "Tilaus,Leveysaste,Pituusaste,Määrä,Alkaa,Päättyy,Kesto [min],Kuljettaja",
}


@pytest.mark.parametrize("language", OTHERS)
def test_a_table_may_have_headings_in_other_languages(language: str) -> None:
    fields = [_taken_for(heading) for heading in (ENGLISH, OTHERS[language])]
    assert fields[0][-1] == "vehicle"
    assert "ignored" not in fields[0]
    assert fields[1] == fields[0]


def _taken_for(heading: str) -> list[str]:
    file = NamedFile("orders.csv", (heading + ROWS).encode())
    return [column.taken_for for column in read_files([file], Bounds(roads=LIMITS.roads)).columns]
