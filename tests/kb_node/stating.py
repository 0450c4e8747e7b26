"""A small TBox with properties of every kind, and maps that use it."""

from semmap.nodes.kb_node.documents import rdf
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from tests.kb_node import home

PROPERTIES = """
dm:Color a owl:Class ; rdfs:subClassOf dm:Property .
dm:color_red a owl:NamedIndividual , dm:Color ; rdfs:label "red"@en , "rosso"@it .
dm:color_blue a owl:NamedIndividual , dm:Color ; rdfs:label "blue"@en .
dm:mood_blue a owl:NamedIndividual , dm:Property ; rdfs:label "blue"@en .
dm:hasColor a owl:ObjectProperty ; rdfs:range dm:Color ; rdfs:label "has color"@en , "ha colore"@it .
dm:hasMainColor a owl:ObjectProperty , owl:FunctionalProperty ; rdfs:subPropertyOf dm:hasColor .
dm:Red a owl:Class ; rdfs:subClassOf dm:Color .
dm:hasOnlyColor a owl:ObjectProperty ; rdfs:subPropertyOf dm:hasMainColor .
dm:blushes a owl:ObjectProperty ; rdfs:subPropertyOf dm:hasColor ; rdfs:range dm:Red .
dm:isOn a owl:ObjectProperty , owl:AsymmetricProperty , owl:IrreflexiveProperty .
dm:isOpen a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:domain dm:Object ; rdfs:range xsd:boolean ;
    rdfs:label "is open"@en ; rdfs:comment "Whether it stands open." .
dm:seats a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:nonNegativeInteger .
dm:mass a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:float .
dm:note a owl:DatatypeProperty ; rdfs:range rdfs:Literal .
dm:serial a owl:DatatypeProperty ; rdfs:range xsd:string .
dm:madeOn a owl:DatatypeProperty ; rdfs:range xsd:dateTime .
dm:anything a owl:DatatypeProperty .
"""
TBOX = rdf.parse((home.TBOX_TURTLE + PROPERTIES).encode(), "tbox.ttl", label_prefix="t")


def new_map(folder):
    """Return a map with `chair1` and the place `kitchen1`."""
    made = home.new_map(folder, TBOX)
    kitchen = (v.entity_iri("kitchen1"), v.RDF_TYPE, v.dm("Kitchen"))
    made.commit(home.transaction("begin", [*home.chair(), kitchen]))
    return made


def statement(property_, *values):
    """Return the statement that a property has these values."""
    return Statement(property=property_, values=values)


def edited(semantic_map, **fields):
    """Commit an edit of `chair1`."""
    return semantic_map.commit(editing(semantic_map, **fields))


def editing(semantic_map, **fields):
    """Return the transaction of an edit of `chair1`."""
    edit = Edit(**{"name": "chair1", **fields})
    return Transaction(id=f"{semantic_map.seq} {fields}", source="operator", edit=(edit,))


def stated(semantic_map, property_, *values, **others):
    """Commit a property of `chair1`."""
    return edited(semantic_map, set=(statement(property_, *values),), **others)


def unstated(semantic_map, property_, *values):
    """Commit the removal of property values of `chair1`."""
    return edited(semantic_map, unset=(statement(property_, *values),))


def properties(semantic_map, name="chair1"):
    """Return the properties of the entity."""
    return semantic_map.entity(name).properties


def adding(name, **fields):
    """Return the transaction that adds a chair."""
    new = NewEntity(name=name, class_iri=v.bare(v.dm("Chair")), **fields)
    return Transaction(id=f"add {name}", source="operator", add=(new,))
