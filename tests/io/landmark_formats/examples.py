"""A file of every format, with what it holds; those of the format descriptions as they stand."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.landmarks import Landmark


@dataclass(frozen=True)
class Example:
    """A text in one format, and the landmarks in it when read as source."""

    suffix: str
    format: str
    text: str
    landmarks: tuple[Landmark, ...]


OPENSIM_SIDE = Example(
    ".landmarks.csv",
    "OpenSim Creator CSV",
    "name,x,y,z\nlandmark_0,-0.007511,-0.014189,0.122403\n",
    (Landmark("landmark_0", (-0.007511, -0.014189, 0.122403)),),
)
OPENSIM_PAIRS = Example(
    ".csv",
    "OpenSim Creator CSV",
    "name,source.x,source.y,source.z,dest.x,dest.y,dest.z\nfovea,1,2,3,4,5,6\nhead,1,2,3,,,\n",
    (Landmark("fovea", (1, 2, 3), (4, 5, 6)), Landmark("head", (1, 2, 3))),
)
OPENSIM_NAMELESS = Example(
    ".csv",
    "OpenSim Creator CSV",
    "1,2,3,4,5,6\n7,8,9,10,11,12\n",
    (
        Landmark("landmark_0", (1, 2, 3), (4, 5, 6)),
        Landmark("landmark_1", (7, 8, 9), (10, 11, 12)),
    ),
)
SLICER_FCSV = Example(
    ".fcsv",
    "3D Slicer .fcsv",
    "# Markups fiducial file version = 4.11\n"
    "# CoordinateSystem = LPS\n"
    "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
    "1,12.5,-40.2,60.1,0,0,0,1,1,1,0,nasion,,\n",
    (Landmark("nasion", (12.5, -40.2, 60.1)),),
)
SLICER_3 = Example(
    ".fcsv",
    "3D Slicer .fcsv",
    "# Fiducial List file /home/ada/L.fcsv\n"
    "# columns = label,x,y,z,sel,vis\n"
    "L-0,12.5,-40.2,60.1,1,1\n",
    (Landmark("L-0", (12.5, -40.2, 60.1)),),
)
SLICER_JSON = Example(
    ".mrk.json",
    "3D Slicer .mrk.json",
    """{"@schema": "https://raw.githubusercontent.com/Slicer/Slicer/main/Modules/Loadable/Markups/\
Resources/Schema/markups-schema-v1.0.0.json#",
 "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "coordinateUnits": "mm",
  "controlPoints": [
   {"id": "1", "label": "nasion", "position": [12.5, -40.2, 60], "positionStatus": "defined"},
   {"id": "2", "label": "inion", "position": "", "positionStatus": "undefined"}
  ]}]}
""",
    (Landmark("nasion", (12.5, -40.2, 60.0)), Landmark("inion")),
)
BIGWARP = Example(
    ".bigwarp.csv",
    "BigWarp CSV",
    '"Pt-0","true","193.15","163.57","130.0","216.01","233.33","126.86"\n'
    '"Pt-1","false","1.5","2","3","Infinity","Infinity","Infinity"\n',
    (
        Landmark("Pt-0", (193.15, 163.57, 130.0), (216.01, 233.33, 126.86)),
        Landmark("Pt-1", (1.5, 2, 3)),
    ),
)
MESHLAB = Example(
    ".pp",
    "MeshLab .pp",
    '<PickedPoints><point x="-0.138" y="-0.021" z="0.0218" active="1" name="p1"/></PickedPoints>\n',
    (Landmark("p1", (-0.138, -0.021, 0.0218)),),
)
IDAV = Example(
    ".pts",
    "IDAV Landmark .pts",
    "Version 1.0\n2\nS000 -11.37 57.22 -15.77\nC000-000 9999 9999 9999\n",
    (Landmark("S000", (-11.37, 57.22, -15.77)), Landmark("C000-000")),
)
MORPHOLOGIKA = Example(
    ".morphologika.txt",
    "Morphologika",
    "[Individuals]\r\n2\r\n[LANDMARKS]\r\n2\r\n[dimensions]\r\n3\r\n[names]\r\nfemur\r\ntibia\r\n"
    "[rawpoints]\r\n'#1\r\n1 2 3\r\n4\t5\t6\r\n'#2\r\n7 8 9\r\n10 11 12\r\n",
    (Landmark("landmark_0", (1, 2, 3)), Landmark("landmark_1", (4, 5, 6))),
)
TPS = Example(
    ".tps",
    "TPS",
    "LM3=2\n1 2 3\nNA NA NA\nID=femur\n",
    (Landmark("landmark_0", (1, 2, 3)), Landmark("landmark_1")),
)
MNI_TAG = Example(
    ".tag",
    "MNI .tag",
    "MNI Tag Point File\nVolumes = 2;\nPoints =\n"
    ' 1.5 2.5 3.5 10.5 20.5 30.5 "nasion"\n 4 5 6 40 50 60 "left tragus";\n',
    (
        Landmark("nasion", (1.5, 2.5, 3.5), (10.5, 20.5, 30.5)),
        Landmark("left tragus", (4, 5, 6), (40, 50, 60)),
    ),
)

SLICER_TABLE = Example(
    ".csv",
    "3D Slicer control-point table",
    "label,r,a,s,defined,selected,visible,locked,description\n"
    "nasion,1,2,3,1,1,1,0,worn\nbregma,0,0,0,0,1,1,0,\n",
    (Landmark("nasion", (1, 2, 3), note="worn"), Landmark("bregma")),
)
MORPHOJ = Example(
    ".csv",
    "Table of specimens (MorphoJ)",
    "Id,LM1x,LM1y,LM1z,LM2x,LM2y,LM2z,LM3x,LM3y,LM3z\n"
    "fem01,1,2,3,4,5,6,,,\nfem02,1.1,2,3,4,5,6,7,8,9\n",
    (Landmark("LM1", (1, 2, 3)), Landmark("LM2", (4, 5, 6)), Landmark("LM3")),
)
NTS_SINGLE = Example(
    ".nts",
    "NTS",
    '"fem01\n1 2 3 0 DIM=3\n1 2 3\n4 5 6\n',
    (Landmark("landmark_0", (1, 2, 3)), Landmark("landmark_1", (4, 5, 6))),
)
LANDMARK_DTA = Example(
    ".dta",
    "NTS",
    "1 2L 6 1 9999 DIM=3\n\nfem 01.ply\nfem 02.ply\n\n1 2 3\n9999 9999 9999\n7 8 9\n10 11 12\n",
    (Landmark("landmark_0", (1, 2, 3)), Landmark("landmark_1")),
)
AMIRA_PAIRS = Example(
    ".landmarkAscii",
    "Amira .landmarkAscii",
    "# Avizo 3D ASCII 2.0\n\ndefine Markers 2\n\nParameters {\n    NumSets 2,\n"
    '    ContentType "LandmarkSet"\n}\n\nMarkers { float[3] Coordinates } @1\n'
    "Markers { float[3] Coordinates2 } @2\n\n# Data section follows\n"
    "@1\n1 2 3\n4 5 6\n\n@2\n7 8 9\n10 11 12\n",
    (
        Landmark("landmark_0", (1, 2, 3), (7, 8, 9)),
        Landmark("landmark_1", (4, 5, 6), (10, 11, 12)),
    ),
)
BIGWARP_JSON = Example(
    ".bigwarp.json",
    "BigWarp JSON",
    """{"type": "BigWarpLandmarks", "numDimensions": 3,
 "movingPoints": [[1, 2, 3], [4, 5, 6]], "fixedPoints": [[7, 8, 9], [Infinity, Infinity, Infinity]],
 "active": [true, false], "names": ["Pt-0", "Pt-1"]}
""",
    (Landmark("Pt-0", (1, 2, 3), (7, 8, 9)), Landmark("Pt-1", (4, 5, 6))),
)
BLANK_TABLE = Example(
    ".xyz",
    "Table between blanks",
    "2\nnasion 1.0 2.0 3.0\nleft tragus 4.0 5.0 6.0\n",
    (Landmark("nasion", (1, 2, 3)), Landmark("left tragus", (4, 5, 6))),
)

EXAMPLES = (
    OPENSIM_SIDE,
    OPENSIM_PAIRS,
    OPENSIM_NAMELESS,
    SLICER_FCSV,
    SLICER_3,
    SLICER_JSON,
    BIGWARP,
    MESHLAB,
    IDAV,
    MORPHOLOGIKA,
    TPS,
    MNI_TAG,
    SLICER_TABLE,
    MORPHOJ,
    NTS_SINGLE,
    LANDMARK_DTA,
    AMIRA_PAIRS,
    BIGWARP_JSON,
    BLANK_TABLE,
)
